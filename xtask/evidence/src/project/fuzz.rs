//! Long fuzzing of everything that reads what a user wrote; the short CI gives each target some thousand rounds.

use std::path::Path;

use anyhow::Result;
use xtask_output::{Output, Progress};

use super::cargo_test::passed_tests;

/// Where the targets are: package, arguments behind it, and what they read.
const RUNS: [(&str, &[&str], &str); 2] = [
    (
        "haptical-fuzz",
        &["--test", "it"],
        "device files, identified.toml, rigs, effects, URDF, logs as CSV and as gzip",
    ),
    ("haptical-cli", &["fuzz"], "arguments of the command"),
];

/// Writes the section.
pub(crate) fn section(output: &mut Output, root: &Path, seconds: u64) -> Result<()> {
    output.section("Fuzzing");
    output.words(format!(
        "bolero's targets, each for {seconds} s with random changes of files of `fixtures` (its random engine, which stable \
         Rust has; no coverage guides it): what is read is refused, or finite and can be written and read again. A panic, \
         or a round that takes long, fails."
    ));
    let progress = Progress::new("fuzz", RUNS.len());
    for (package, further, read) in RUNS {
        let passed = passed_tests(
            root,
            &[&["-p", package], further].concat(),
            &[("HAPTICAL_FUZZ_SECONDS", seconds.to_string())],
        )?;
        output.verdict(
            passed > 0,
            format!(
                "`HAPTICAL_FUZZ_SECONDS={seconds} cargo test -p {package} {}`: {read}",
                further.join(" ")
            ),
        );
        output.terminal(format!("     {passed} targets of {package}"));
        progress.step();
    }
    Ok(())
}
