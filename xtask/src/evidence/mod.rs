//! Evidence for numbers that others may cite: `cargo xtask evidence` writes docs/evidence.md.

mod document;
mod mgh;
mod nist;

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::output::{Layout, Output};
use crate::progress::Progress;

/// Arguments of `evidence`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask evidence --quick --check")]
pub(crate) struct Arguments {
    /// Folder for tables and report.
    #[arg(long, default_value = "target/evidence")]
    out: PathBuf,
    /// Leave out sections that take more than a minute; docs/evidence.md is not written then.
    #[arg(long)]
    quick: bool,
    /// Do not write docs/evidence.md: fail where it does not hold this run's sections.
    #[arg(long)]
    check: bool,
}

/// The committed file, from the root of the repository.
const DOCUMENT: &str = "docs/evidence.md";

const LEAD: &str = "Figures of `cargo xtask evidence`, which writes this file; `cargo xtask evidence --check` says whether it \
                    is stale. The report with the same tables is `target/evidence/report.html`. The last digit of a score and \
                    the number of steps depend on the exponentials of the platform: x86-64 Linux here.";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Runs the job.
pub(crate) fn evidence(arguments: &Arguments) -> Result<()> {
    let mut output = Output::new(Layout {
        stem: "evidence",
        figures: "figures/",
        tables: "tables/",
    });
    let progress = Progress::new("evidence", 2);
    nist::section(&mut output, &root().join("fixtures/nist"))?;
    progress.step();
    mgh::section(&mut output, &root().join("fixtures/mgh"))?;
    progress.step();
    drop(progress);
    let lines = output.write(&arguments.out, "Evidence", LEAD)?;
    for text in lines {
        println!("{text}");
    }
    println!("report: {}", arguments.out.join("report.html").display());
    let text = std::fs::read_to_string(arguments.out.join("evidence.md"))?;
    let path = root().join(DOCUMENT);
    if arguments.check {
        document::check(&std::fs::read_to_string(&path).unwrap_or_default(), &text)?;
        println!("{DOCUMENT} is up to date");
    } else if !arguments.quick {
        haptical_report::write_atomically(&path, text.as_bytes())?;
        println!("written: {DOCUMENT}");
    }
    Ok(())
}
