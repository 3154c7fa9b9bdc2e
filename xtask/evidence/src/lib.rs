//! Evidence for numbers that others may cite: `cargo xtask evidence` writes docs/evidence.md.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command talks to its terminal"
)]
#![allow(
    clippy::missing_errors_doc,
    reason = "the errors are texts for a person"
)]

mod basin;
mod coverage_tables;
mod document;
mod force_truth;
mod intervals;
mod mgh;
mod nist;
mod parallel_joints;
mod poses;
mod project;
mod rigs;

use std::path::{Path, PathBuf};

use anyhow::Result;
use xtask_output::{Layout, Output, Progress};

/// Arguments of `evidence`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask evidence --quick --check")]
pub struct Arguments {
    /// Folder for tables and report.
    #[arg(long, default_value = "target/evidence")]
    out: PathBuf,
    /// Leave out sections that take more than a minute; docs/evidence.md is not written then.
    #[arg(long)]
    quick: bool,
    /// Simulated devices of each trial of the intervals.
    #[arg(long, default_value_t = 1000)]
    devices: usize,
    /// One part alone: its sections replace those of docs/evidence.md.
    #[arg(long, value_parser = PARTS)]
    only: Option<String>,
    /// Do not write docs/evidence.md: fail where it does not hold this run's sections.
    #[arg(long)]
    check: bool,
}

/// The committed file, from the root of the repository.
const DOCUMENT: &str = "docs/evidence.md";

/// What `--only` names.
const PARTS: [&str; 11] = [
    "solver",
    "intervals",
    "basin",
    "parallel-joints",
    "poses",
    "formats",
    "fuzz",
    "python",
    "licences",
    "coverage",
    "mutants",
];

/// Devices of each trial with `--quick`.
const QUICK_DEVICES: usize = 4;

/// How long each fuzz target runs.
const FUZZ_SECONDS: u64 = 120;

const LEAD: &str = "Figures of `cargo xtask evidence`, which writes this file; `cargo xtask evidence --check` says whether it \
                    is stale. The report with the same tables is `target/evidence/report.html`. The last digit of a score and \
                    the number of steps depend on the exponentials of the platform: x86-64 Linux here.";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Runs the job.
pub fn evidence(arguments: &Arguments) -> Result<()> {
    let mut output = Output::new(Layout {
        stem: "evidence",
        figures: "figures/",
        tables: "tables/",
    });
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
    let many = if arguments.quick {
        &mut unread
    } else {
        &mut output
    };
    let devices = if arguments.quick {
        QUICK_DEVICES
    } else {
        arguments.devices
    };
    if runs("intervals") {
        intervals::section(many, devices)?;
    }
    if runs("basin") {
        basin::section(many, devices)?;
    }
    if runs("parallel-joints") {
        parallel_joints::section(&mut output)?;
    }
    if runs("poses") && !arguments.quick {
        poses::section(&mut output, devices.min(200))?;
    }
    if runs("formats") && !arguments.quick {
        project::formats::section(&mut output, &root())?;
    }
    if runs("fuzz") && !arguments.quick {
        project::fuzz::section(&mut output, &root(), FUZZ_SECONDS)?;
    }
    if runs("python") && !arguments.quick {
        project::python::section(&mut output, &root())?;
    }
    if runs("licences") {
        project::licences::section(&mut output)?;
    }
    if runs("coverage") && !arguments.quick {
        project::quality::coverage(&mut output, &arguments.out)?;
    }
    if runs("mutants") && !arguments.quick {
        project::quality::mutants(&mut output, &arguments.out)?;
    }
    let lines = output.write(&arguments.out, "Evidence", LEAD)?;
    for text in lines {
        println!("{text}");
    }
    println!("report: {}", arguments.out.join("report.html").display());
    let text = std::fs::read_to_string(arguments.out.join("evidence.md"))?;
    let text = document::without_figures(&text);
    let path = root().join(DOCUMENT);
    if arguments.check {
        document::check(&std::fs::read_to_string(&path).unwrap_or_default(), &text)?;
        println!("{DOCUMENT} is up to date");
    } else if !arguments.quick {
        let text = match &arguments.only {
            None => text,
            Some(_) => document::with_sections(
                &std::fs::read_to_string(&path).unwrap_or(text.clone()),
                &text,
            ),
        };
        haptical_report::write_atomically(&path, text.as_bytes())?;
        println!("written: {DOCUMENT}");
    }
    Ok(())
}
