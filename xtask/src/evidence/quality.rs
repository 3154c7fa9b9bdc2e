//! How much of the code tests reach, and how many planted faults they notice: with tools that must be installed.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use haptical_report::{Cell, Column, Table};
use serde::Deserialize;

use crate::output::Output;

/// Least share of a library crate's lines that its tests run.
const COVERED_PERCENT: f64 = 90.0;
/// Largest share of mutants that may survive.
const SURVIVING_PERCENT: f64 = 5.0;
/// Crates whose mutants are tried.
const MUTATED: [&str; 3] = [
    "haptical-transmission",
    "haptical-kinematics",
    "haptical-metrics",
];
/// Library crates whose lines are counted: those that others can depend on.
const LIBRARIES: [&str; 14] = [
    "batch",
    "calibration",
    "data",
    "design",
    "diagnosis",
    "identification",
    "kinematics",
    "linalg",
    "metrics",
    "model",
    "report",
    "runtime",
    "simulator",
    "transmission",
];
/// Survivors that were looked into, by what stands in the tool's list, and why no test can tell them.
const EXPLAINED: &str = "fixtures/mutants/survivors.toml";

/// A survivor that was looked into.
#[derive(Debug, Deserialize)]
struct Explained {
    /// As cargo-mutants names it, without line and column.
    mutant: String,
    why: String,
}

#[derive(Debug, Default, Deserialize)]
struct Survivors {
    #[serde(default)]
    survivor: Vec<Explained>,
}

fn is_installed(tool: &str) -> bool {
    let mut command = Command::new("cargo");
    command
        .args([tool, "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Writes the coverage section.
pub(super) fn coverage(output: &mut Output, out: &Path) -> Result<()> {
    output.section("Line coverage");
    if !is_installed("tarpaulin") {
        output.words("Not run: `cargo install cargo-tarpaulin` first.");
        return Ok(());
    }
    let folder = out.join("coverage");
    std::fs::create_dir_all(&folder)?;
    let mut command = Command::new("cargo");
    command
        .current_dir(super::root())
        .args([
            "tarpaulin",
            "--workspace",
            "--exclude",
            "xtask",
            "--engine",
            "ptrace",
        ])
        .args(["--skip-clean", "--out", "json", "--output-dir"])
        .arg(std::path::absolute(&folder)?)
        .args([
            "--target-dir",
            "target/coverage",
            "--timeout",
            "900",
            "--locked",
        ]);
    let status = command
        .stdout(Stdio::null())
        .status()
        .context("cargo tarpaulin")?;
    if !status.success() {
        output.verdict(false, "cargo tarpaulin ended with an error".to_owned());
        return Ok(());
    }
    let report = std::fs::read_to_string(folder.join("tarpaulin-report.json"))?;
    let report: CoverageReport = serde_json::from_str(&report).context("tarpaulin-report.json")?;
    let columns = ["crate", "lines", "covered", "percent"]
        .map(|name| Column::new(name, ""))
        .to_vec();
    let mut table = Table::new(
        "Lines of the library crates that tests of the workspace run",
        columns,
    );
    let mut below = Vec::new();
    for library in LIBRARIES {
        let source = format!("crates/{library}/src/");
        let own = report
            .files
            .iter()
            .filter(|file| file.path.join("/").contains(&source));
        let (covered, lines) = own.fold((0, 0), |(covered, lines), file| {
            (covered + file.covered, lines + file.coverable)
        });
        let percent = 100.0 * covered as f64 / (lines as f64).max(1.0);
        if lines > 0 && percent < COVERED_PERCENT {
            below.push(library);
        }
        table.push(vec![
            library.into(),
            Cell::number(lines as f64, 0),
            Cell::number(covered as f64, 0),
            Cell::number(percent, 1),
        ])?;
    }
    output.words(
        "By cargo-tarpaulin (ptrace), which needs no part of LLVM that fits the compiler; cargo-llvm-cov does. It counts \
         lines by the debug information, so lines that the optimiser moved may count as missed.",
    );
    output.table("coverage", table)?;
    let named = if below.is_empty() {
        "none".to_owned()
    } else {
        below.join(", ")
    };
    output.verdict(
        below.is_empty(),
        format!("crates below {COVERED_PERCENT} % of their lines: {named}"),
    );
    Ok(())
}

#[derive(Debug, Deserialize)]
struct CoverageReport {
    files: Vec<CoveredFile>,
}

#[derive(Debug, Deserialize)]
struct CoveredFile {
    path: Vec<String>,
    covered: usize,
    coverable: usize,
}

/// Writes the section of planted faults.
pub(super) fn mutants(output: &mut Output, out: &Path) -> Result<()> {
    output.section("Planted faults");
    if !is_installed("mutants") {
        output.words("Not run: `cargo install cargo-mutants` first.");
        return Ok(());
    }
    let explained: Survivors = match std::fs::read_to_string(super::root().join(EXPLAINED)) {
        Ok(text) => toml::from_str(&text).context(EXPLAINED)?,
        Err(_) => Survivors::default(),
    };
    let columns = [
        "crate",
        "mutants",
        "caught",
        "not built",
        "timed out",
        "missed",
    ];
    let columns = columns.map(|name| Column::new(name, "")).to_vec();
    let mut table = Table::new(
        "Mutants by cargo-mutants, tested with the crate's own tests",
        columns,
    );
    let (mut all, mut survivors) = (0, Vec::new());
    for package in MUTATED {
        let folder = std::path::absolute(out.join("mutants").join(package))?;
        std::fs::create_dir_all(&folder)?;
        let mut command = Command::new("cargo");
        command
            .current_dir(super::root())
            .args([
                "mutants",
                "--package",
                package,
                "--no-shuffle",
                "--jobs",
                "2",
                "--timeout",
                "120",
                "--output",
            ])
            .arg(&folder)
            .stdout(Stdio::null());
        // its status is 2 where mutants were missed
        command.status().context("cargo mutants")?;
        let lines = |name: &str| -> Vec<String> {
            let path = folder.join("mutants.out").join(name);
            let text = std::fs::read_to_string(path).unwrap_or_default();
            text.lines().map(str::to_owned).collect()
        };
        let [caught, unviable, timeout, missed] =
            ["caught.txt", "unviable.txt", "timeout.txt", "missed.txt"].map(lines);
        let total = caught.len() + timeout.len() + missed.len();
        all += total;
        table.push(vec![
            package.into(),
            Cell::number(total as f64, 0),
            Cell::number(caught.len() as f64, 0),
            Cell::number(unviable.len() as f64, 0),
            Cell::number(timeout.len() as f64, 0),
            Cell::number(missed.len() as f64, 0),
        ])?;
        survivors.extend(missed);
    }
    output.table("mutants", table)?;
    for survivor in &survivors {
        let name = without_place(survivor);
        let why = explained.survivor.iter().find(|known| known.mutant == name);
        let why = why.map_or("not looked into", |known| known.why.as_str());
        output.words(format!("- survived: {name}: {why}"));
    }
    let percent = 100.0 * survivors.len() as f64 / f64::from(all.max(1) as u32);
    output.verdict(
        all > 0 && percent <= SURVIVING_PERCENT,
        format!("{percent:.1} % of {all} mutants survive (at most {SURVIVING_PERCENT} %)"),
    );
    Ok(())
}

/// `crates/x/src/y.rs:12:3: replace ...` without line and column, which move.
fn without_place(mutant: &str) -> String {
    match mutant.split_once(':') {
        Some((file, rest)) => {
            let words = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == ':');
            format!("{file}:{words}")
        }
        None => mutant.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::without_place;

    #[test]
    fn mutants_keep_their_name_when_lines_move() {
        let name = without_place("crates/metrics/src/rms.rs:12:34: replace + with - in rms");
        assert_eq!(name, "crates/metrics/src/rms.rs: replace + with - in rms");
    }
}
