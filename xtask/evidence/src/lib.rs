//! Evidence for numbers that others may cite: `cargo xtask evidence` writes docs/evidence.md and the tables behind it.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::missing_errors_doc,
    reason = "a command talks to its terminal, and its errors are texts for a person"
)]

mod basin;
mod coverage_tables;
mod document;
mod effects;
mod force_truth;
mod held;
mod intervals;
mod mgh;
mod nist;
mod noise_memory;
mod parallel_joints;
mod poses;
mod project;
mod rigs;
mod watch;
mod watch_day;

use std::path::PathBuf;

use anyhow::Result;
use haptical_report::write_atomically;
use xtask_output::{Layout, Output, Progress, root};

use document::{CLAIMS, PARTS};

/// Arguments of `evidence`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask evidence --quick --check")]
pub struct Arguments {
    /// Folder for tables and report.
    #[arg(long, default_value = "target/evidence")]
    out: PathBuf,
    /// Leave out sections that take more than a minute; nothing in docs is written then.
    #[arg(long)]
    quick: bool,
    /// Simulated devices of each trial of the intervals.
    #[arg(long, default_value_t = 1000)]
    devices: usize,
    /// One part alone: its page in docs/evidence is written again.
    #[arg(long, value_parser = PARTS.map(|part| part.name))]
    only: Option<String>,
    /// Kinds of effects that are counted again, with commas; the page keeps the rows of the others.
    #[arg(long, value_delimiter = ',', requires = "only", value_parser = effects::kinds())]
    kinds: Vec<String>,
    /// Write nothing in docs: fail where its pages of evidence do not hold this run's sections.
    #[arg(long)]
    check: bool,
}

/// Devices of each trial with `--quick`.
const QUICK_DEVICES: usize = 4;

/// How long each fuzz target runs.
const FUZZ_SECONDS: u64 = 120;

const LEAD: &str = "All tables of this run. docs/evidence.md has the claims.";

/// Runs the job.
pub fn evidence(arguments: &Arguments) -> Result<()> {
    let mut output = Output::new(Layout::in_folders("evidence"));
    let runs = |name: &str| arguments.only.as_deref().is_none_or(|only| only == name);
    if runs("solver") {
        let progress = Progress::new("solver", 2);
        nist::section(&mut output, &root().join("fixtures/nist"))?;
        progress.step();
        mgh::section(&mut output, &root().join("fixtures/mgh"))?;
        progress.step();
    }
    // that they run: so few devices say nothing, and the document keeps what many said
    let mut unread = Output::default();
    let (many, devices) = match arguments.quick {
        true => (&mut unread, QUICK_DEVICES),
        false => (&mut output, arguments.devices),
    };
    let long = |name: &str| runs(name) && !arguments.quick;
    if runs("intervals") {
        intervals::section(many, devices)?;
    }
    if long("noise-memory") {
        noise_memory::section(many, devices.min(200))?;
    }
    if long("effects") {
        let page = root().join("docs/evidence/effects.md");
        let held = std::fs::read_to_string(page).unwrap_or_default();
        effects::section(many, devices.min(500), (&arguments.kinds, &held))?;
    }
    if runs("basin") {
        basin::section(many, devices)?;
    }
    if runs("parallel-joints") {
        parallel_joints::section(&mut output)?;
    }
    if long("poses") {
        poses::section(&mut output, devices.min(200))?;
    }
    if long("watch") {
        watch::section(&mut output, devices.min(200))?;
        watch_day::day(&mut output)?;
    }
    if long("formats") {
        project::cargo_test::formats(&mut output, &root())?;
    }
    if long("fuzz") {
        project::cargo_test::fuzz(&mut output, &root(), FUZZ_SECONDS)?;
    }
    if long("python") {
        project::python::section(&mut output, &root())?;
    }
    if runs("licences") {
        project::licences::section(&mut output)?;
    }
    if long("coverage") {
        project::quality::coverage(&mut output, &arguments.out)?;
    }
    output.write(&arguments.out, "Evidence", LEAD)?;
    if arguments.quick && !arguments.check {
        return Ok(());
    }
    let text = std::fs::read_to_string(arguments.out.join("evidence.md"))?;
    publish(&document::without_figures(&text), arguments.check)
}

/// Writes the pages of a run's parts and the page of claims, or checks those that are committed.
fn publish(run: &str, check: bool) -> Result<()> {
    document::assert_placed(run)?;
    let committed = |path: &str| std::fs::read_to_string(root().join(path)).unwrap_or_default();
    let publish = |path: &str, text: &str| -> Result<()> {
        if check {
            return document::check(path, &committed(path), text);
        }
        Ok(write_atomically(&root().join(path), text.as_bytes())?)
    };
    let mut pages = Vec::new();
    for part in PARTS {
        let path = part.path();
        let held = committed(&path);
        let page = part.page(&held, run);
        if let Some(page) = &page {
            publish(&path, page)?;
        }
        pages.push((part, page.unwrap_or(held)));
    }
    publish(CLAIMS, &document::claims(&pages))?;
    println!(
        "{CLAIMS} is {}",
        if check { "up to date" } else { "written" }
    );
    Ok(())
}
