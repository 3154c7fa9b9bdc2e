//! Runs of `cargo test` whose passed tests are counted.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};

/// Runs the tests, optimised, and counts those that passed.
///
/// # Errors
/// If one fails, with all that was printed.
pub(crate) fn passed_tests(
    root: &Path,
    arguments: &[&str],
    environment: &[(&str, String)],
) -> Result<usize> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let done = Command::new(cargo)
        .current_dir(root)
        .args(["test", "--profile", "jobs", "--quiet"])
        .args(arguments)
        .envs(environment.iter().map(|(name, value)| (name, value)))
        .output()
        .context("cargo")?;
    let text = String::from_utf8_lossy(&done.stdout);
    if !done.status.success() {
        bail!(
            "cargo test {} failed:\n{text}\n{}",
            arguments.join(" "),
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
