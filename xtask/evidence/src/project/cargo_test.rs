//! Sections about runs of `cargo test`: readers of Parquet and bags of ROS 2 with their features, long fuzzing.

use std::path::Path;

use anyhow::Result;
use xtask_output::{Output, Progress, cargo, said};

/// The features of the readers.
const FEATURES: &str = "parquet,mcap,rosbag2";
/// Tests that need them: package, and arguments behind it.
const READERS: [(&str, &[&str]); 2] = [
    ("haptical-data", &[]),
    ("haptical-cli", &["--test", "it", "import"]),
];

/// Fuzz targets: package, arguments behind it, and what they read; the short CI gives each some thousand rounds.
const FUZZED: [(&str, &[&str], &str); 2] = [
    (
        "haptical-fuzz",
        &["--test", "it"],
        "device files, identified.toml, rigs, effects, URDF, logs as CSV and as gzip",
    ),
    ("haptical-cli", &["fuzz"], "arguments of the command"),
];

pub(crate) fn formats(output: &mut Output, root: &Path) -> Result<()> {
    output.section("Parquet and bags of ROS 2");
    output.words(
        "The command reads logs as Parquet files, and bags with joint states of ROS 2 as MCAP and as rosbag2's SQLite, with the \
         features `parquet`, `mcap` and `rosbag2`, which are on by default in `haptical-cli` and off in the libraries. Their tests \
         read files that pyarrow and the Python libraries of MCAP and of rosbags wrote, and damaged ones.",
    );
    for (package, further) in READERS {
        let arguments = [&["--features", FEATURES, "-p", package], further].concat();
        let passed = passed_tests(root, &arguments, &[])?;
        let command = arguments.join(" ");
        let text = format!("`cargo test {command}`: every test passed");
        output.verdict(passed > 0, text);
        output.terminal(format!("     {passed} tests of {package}"));
    }
    Ok(())
}

pub(crate) fn fuzz(output: &mut Output, root: &Path, seconds: u64) -> Result<()> {
    output.section("Fuzzing");
    output.words(format!(
        "bolero's targets, each for {seconds} s with random changes of files of `fixtures` (its random engine, which stable \
         Rust has; no coverage guides it): what is read is refused, or finite and can be written and read again. A panic, \
         or a round that takes long, fails."
    ));
    let progress = Progress::new("fuzz", FUZZED.len());
    for (package, further, read) in FUZZED {
        let arguments = [&["-p", package], further].concat();
        let environment = [("HAPTICAL_FUZZ_SECONDS", seconds.to_string())];
        let passed = passed_tests(root, &arguments, &environment)?;
        let command = arguments.join(" ");
        let text = format!("`HAPTICAL_FUZZ_SECONDS={seconds} cargo test {command}`: {read}");
        output.verdict(passed > 0, text);
        output.terminal(format!("     {passed} targets of {package}"));
        progress.step();
    }
    Ok(())
}

/// Runs tests, optimised, and counts those that passed; an error with all that was printed where one fails.
fn passed_tests(root: &Path, arguments: &[&str], environment: &[(&str, String)]) -> Result<usize> {
    let mut command = cargo();
    command.args(["test", "--profile", "jobs", "--quiet"]);
    command.args(arguments).current_dir(root);
    command.envs(environment.iter().map(|(name, value)| (name, value)));
    Ok(count(&said(&mut command)?))
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
