//! Parquet and bags of ROS 2: the tests of the readers and of the command with them.

use std::path::Path;

use anyhow::Result;
use xtask_output::Output;

use super::cargo_test::passed_tests;

/// Tests that need the features: package, and arguments behind it.
const RUNS: [(&str, &[&str]); 2] = [
    ("haptical-data", &[]),
    ("haptical-cli", &["--test", "it", "import"]),
];

/// The features.
const FEATURES: &str = "parquet,mcap,rosbag2";

/// Writes the section.
pub(crate) fn section(output: &mut Output, root: &Path) -> Result<()> {
    output.section("Parquet and bags of ROS 2");
    output.words(
        "The command reads logs as Parquet files, and bags with joint states of ROS 2 as MCAP and as rosbag2's SQLite, with the \
         features `parquet`, `mcap` and `rosbag2`, which are on by default in `haptical-cli` and off in the libraries. Their tests \
         read files that pyarrow and the Python libraries of MCAP and of rosbags wrote, and damaged ones.",
    );
    for (package, further) in RUNS {
        let passed = passed_tests(
            root,
            &[&["--features", FEATURES, "-p", package], further].concat(),
            &[],
        )?;
        let command = ["cargo test --features", FEATURES, "-p", package]
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
