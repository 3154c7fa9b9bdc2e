//! Parquet and MCAP, which the short CI does not build: the tests of the readers and of the command with them.

use std::path::Path;

use anyhow::Result;
use xtask_output::Output;

use super::cargo_test::passed_tests;

/// Tests that need the features: package, and arguments behind it.
const RUNS: [(&str, &[&str]); 2] = [
    ("haptical-data", &[]),
    ("haptical-cli", &["--test", "it", "import"]),
];

/// Writes the section.
pub(crate) fn section(output: &mut Output, root: &Path) -> Result<()> {
    output.section("Parquet and MCAP");
    output.words(
        "Logs as Parquet files and as MCAP files with joint states of ROS 2 are read with the features `parquet` and \
         `mcap` of `haptical-data` and `haptical-cli`, which are not on by default: they add about two minutes of \
         processor time to a build from nothing. Their tests read files that pyarrow and MCAP's Python library wrote, \
         and damaged ones.",
    );
    for (package, further) in RUNS {
        let passed = passed_tests(
            root,
            &[&["--features", "parquet,mcap", "-p", package], further].concat(),
            &[],
        )?;
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
