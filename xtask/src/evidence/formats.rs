//! Parquet and MCAP, which the short CI does not build: the tests of the readers and of the command with them.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::output::Output;

/// Tests that need the features: package, and arguments behind it.
const RUNS: [(&str, &[&str]); 2] = [
    ("haptical-data", &[]),
    ("haptical-cli", &["--test", "it", "import"]),
];

/// Writes the section.
pub(super) fn section(output: &mut Output, root: &Path) -> Result<()> {
    output.section("Parquet and MCAP");
    output.words(
        "Logs as Parquet files and as MCAP files with joint states of ROS 2 are read with the features `parquet` and \
         `mcap` of `haptical-data` and `haptical-cli`, which are not on by default: they add about two minutes of \
         processor time to a build from nothing. Their tests read files that pyarrow and MCAP's Python library wrote, \
         and damaged ones.",
    );
    for (package, further) in RUNS {
        let passed = passed_tests(root, package, further)?;
        let command = ["cargo test --features parquet,mcap -p", package]
            .iter()
            .chain(further)
            .copied()
            .collect::<Vec<_>>()
            .join(" ");
        output.verdict(passed > 0, format!("`{command}`: every test passed"));
        output.terminal(format!("     {passed} tests of {package}"));
    }
    Ok(())
}

/// Runs the tests and counts those that passed.
fn passed_tests(root: &Path, package: &str, further: &[&str]) -> Result<usize> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let done = Command::new(cargo)
        .current_dir(root)
        .args([
            "test",
            "--release",
            "--quiet",
            "--features",
            "parquet,mcap",
            "-p",
            package,
        ])
        .args(further)
        .output()
        .context("cargo")?;
    let text = String::from_utf8_lossy(&done.stdout);
    if !done.status.success() {
        bail!(
            "tests of {package} failed:\n{text}\n{}",
            String::from_utf8_lossy(&done.stderr)
        );
    }
    Ok(count(&text))
}

/// Adds up the lines `test result: ok. N passed; ...`.
fn count(text: &str) -> usize {
    let passed = |line: &str| {
        let rest = line.trim().strip_prefix("test result: ok. ")?;
        rest.split_once(" passed")?.0.parse::<usize>().ok()
    };
    text.lines().filter_map(passed).sum()
}

#[cfg(test)]
mod tests {
    use super::count;

    #[test]
    fn passed_tests_are_added_up() {
        let text = "running 2 tests\n..\ntest result: ok. 2 passed; 0 failed; 0 ignored\n\n\
                    test result: FAILED. 7 passed; 1 failed\ntest result: ok. 40 passed; 0 failed\n";
        assert_eq!(count(text), 42);
        assert_eq!(count(""), 0);
    }
}
