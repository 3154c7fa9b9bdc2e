//! Public robot descriptions in haptical, Pinocchio and MuJoCo: `cargo xtask descriptions DIR`.
//!
//! Each file is read whole: all its chains from the root, and from each body behind a free or ball joint. Poses of all ends and
//! torques of all joints are compared at random motions. So are new and corrected exports of what was read. A difference that
//! haptical's own words do not name is silent, and ends the job with an error.

mod ask;
mod compare;
mod files;
mod findings;
mod ours;
mod said;
mod subject;
mod table;
#[cfg(test)]
mod tests;
mod written;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::bench_peers::tools::Tools;
use ask::{ask, versions};
use files::{Found, find};
use findings::Row;
use subject::subjects;

/// Arguments of `descriptions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask descriptions ~/robots --out target/descriptions")]
pub struct Arguments {
    /// Folder with URDFs (.urdf) and MJCFs (.xml), searched with all folders in it.
    folder: PathBuf,
    /// A Python with the packages pin and mujoco, in the place of those that the job looks for.
    #[arg(long)]
    python: Option<PathBuf>,
    /// Folder for the table, the request to the peers and their answer.
    #[arg(long, default_value = "target/descriptions")]
    out: PathBuf,
    /// Folder of the Python environment that `bench-peers` has too.
    #[arg(long, default_value = "target/peers")]
    scratch: PathBuf,
}

/// Runs the job.
pub fn run(arguments: &Arguments) -> Result<()> {
    let python = python(arguments)?;
    let versions = versions(&python)?;
    println!("{}", versions.words());
    let found = find(&arguments.folder)?;
    if found.is_empty() {
        bail!(
            "{}: there is no .urdf and no .xml with <mujoco>",
            arguments.folder.display()
        );
    }
    let rows = compared(&python, &arguments.out, &found)?;
    let text = table::table(&rows);
    print!("{text}");
    let path = arguments.out.join("table.md");
    std::fs::write(&path, format!("{}\n\n{text}", versions.words()))
        .with_context(|| path.display().to_string())?;
    println!("table: {}", path.display());
    let silent = table::silent(&rows);
    if silent.is_empty() {
        return Ok(());
    }
    silent.iter().for_each(|line| println!("{line}"));
    bail!("{} silent differences", silent.len())
}

/// The Python that was given, or one that imports both packages.
fn python(arguments: &Arguments) -> Result<PathBuf> {
    if let Some(python) = &arguments.python {
        return Ok(python.clone());
    }
    let tools = Tools::new(&arguments.scratch, false)?;
    let python = tools.python("mujoco, pinocchio", &["mujoco", "pin"]);
    // which of the two is missing is said by what asks them
    Ok(python.unwrap_or_else(|_| PathBuf::from("python3")))
}

/// All files, compared.
fn compared(python: &Path, out: &Path, found: &[Found]) -> Result<Vec<Row>> {
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let mut rows = Vec::new();
    let mut models = Vec::new();
    let mut checks = Vec::new();
    for file in found {
        for read in subjects(file) {
            let row = rows.len();
            match read {
                Err(row) => rows.push(*row),
                Ok(subject) => {
                    let mut own = subject.row();
                    let known = written::add(&subject, row, &mut models, &mut checks);
                    known.into_iter().for_each(|finding| own.add(finding));
                    rows.push(own);
                }
            }
        }
    }
    let answers = ask(python, out, &models)?;
    for (check, answer) in checks.iter().zip(&answers) {
        let Some(row) = rows.get_mut(check.row) else {
            continue;
        };
        let findings = compare::findings(check, answer, row);
        findings.into_iter().for_each(|own| row.add(own));
    }
    Ok(rows)
}
