//! Line coverage of the tests, and the planted faults that they notice: with tools that must be installed.

use std::collections::BTreeMap;
#[cfg(unix)]
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::{MetadataCommand, Target};
use haptical_report::{Cell, Table};
use serde::Deserialize;
use xtask_output::Output;

/// Least share of a library crate's lines that its tests run.
const COVERED_PERCENT: f64 = 90.0;
/// Longest time that the tests of one binary may take, counting; most of a crate's counts are lost where it is too short.
const SECONDS_OF_A_TEST_BINARY: &str = "3600";
/// Compiles what is not measured without counters, as `RUSTC_WRAPPER`: a linear algebra that counts its own lines is not
/// inlined, and the tests that rest on it take 13 times as long. Cargo marks what was asked for by `--package`.
const UNCOUNTED_DEPENDENCIES: &str = r#"#!/bin/sh
if [ -z "$CARGO_PRIMARY_PACKAGE" ]; then
    for argument; do
        shift
        if [ "$argument" != -Cinstrument-coverage ]; then set -- "$@" "$argument"; fi
    done
fi
exec "$@"
"#;
/// Largest share of mutants that may survive.
const SURVIVING_PERCENT: f64 = 5.0;
/// Crates whose mutants are tried, and where their tests are: what has none is not built for each mutant.
const MUTATED: [(&str, &[&str]); 3] = [
    ("haptical-transmission", &["--test=it"]),
    ("haptical-kinematics", &["--lib", "--test=it"]),
    ("haptical-metrics", &["--lib", "--test=it"]),
];
/// Part of the mutants that is tried: one after the other in turn, so that every function has its share.
const SHARD: &str = "0/2";
/// Survivors that were looked into, by their line in the tool's list, and why no test can see them.
const EXPLAINED: &str = "fixtures/mutants/survivors.toml";

/// A survivor that was looked into.
#[derive(Debug, Deserialize)]
struct Explained {
    /// As cargo-mutants names it, without line and column.
    mutant: String,
    /// How many of that name survive: one more is a new one.
    #[serde(default = "one")]
    places: usize,
    why: String,
}

fn one() -> usize {
    1
}

#[derive(Debug, Default, Deserialize)]
struct Survivors {
    #[serde(default)]
    survivor: Vec<Explained>,
}

/// A cargo command with its version, if it is installed.
fn version_of(tool: &str) -> Option<String> {
    let found = Command::new("cargo")
        .args([tool, "--version"])
        .output()
        .ok()?;
    let text = String::from_utf8(found.stdout).ok()?;
    let version = text.split_whitespace().last()?;
    found
        .status
        .success()
        .then(|| format!("cargo-{tool} {version}"))
}

/// Library crates that others can depend on: package and folder, in alphabetical order.
fn libraries() -> Result<Vec<(String, String)>> {
    let metadata = MetadataCommand::new()
        .manifest_path(crate::root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .context("cargo metadata")?;
    let mut found = Vec::new();
    for package in &metadata.packages {
        let published = package.publish.as_ref().is_none_or(|to| !to.is_empty());
        let folder = package
            .manifest_path
            .parent()
            .and_then(|folder| folder.file_name());
        if let (true, true, Some(folder)) = (
            published,
            package.targets.iter().any(Target::is_lib),
            folder,
        ) {
            found.push((package.name.to_string(), folder.to_owned()));
        }
    }
    found.sort();
    Ok(found)
}

/// Runs the libraries' unit and integration tests under cargo-tarpaulin.
fn measure_coverage(libraries: &[(String, String)], folder: &Path) -> Result<CoverageReport> {
    std::fs::create_dir_all(folder)?;
    let wrapper = folder.join("rustc-uncounted-dependencies");
    std::fs::write(&wrapper, UNCOUNTED_DEPENDENCIES)?;
    #[cfg(unix)]
    std::fs::set_permissions(&wrapper, std::fs::Permissions::from_mode(0o755))?;
    let mut command = Command::new("cargo");
    command
        .current_dir(crate::root())
        .args([
            "tarpaulin",
            "--engine",
            "llvm",
            "--locked",
            "--skip-clean",
            "--no-fail-fast",
            // counting unoptimised code takes the tests of the diagnosis half an hour
            "--profile",
            "jobs",
        ])
        .args(["--lib", "--tests", "--timeout", SECONDS_OF_A_TEST_BINARY])
        .args(["--out", "json", "--output-dir"])
        .arg(folder)
        .arg("--target-dir")
        .arg(crate::root().join("target/coverage"))
        .env_remove("CARGO_TARGET_DIR")
        .env("RUSTC_WRAPPER", &wrapper)
        // threads that count in the same lines of a cache wait for each other: two are slower than one
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::null());
    for (package, _) in libraries {
        command.args(["--package", package]);
    }
    command.args(["--", "--test-threads=1"]);
    let status = command.status().context("cargo tarpaulin")?;
    ensure!(status.success(), "cargo tarpaulin ended with {status}");
    let path = folder.join("tarpaulin-report.json");
    let report = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&report).with_context(|| path.display().to_string())
}

/// Writes the coverage section.
pub(crate) fn coverage(output: &mut Output, out: &Path) -> Result<()> {
    output.section("Line coverage");
    let Some(version) = version_of("tarpaulin") else {
        output.words("Not run: `cargo install cargo-tarpaulin` first.");
        return Ok(());
    };
    let libraries = libraries()?;
    let report = measure_coverage(&libraries, &std::path::absolute(out.join("coverage"))?)?;
    let columns = "crate | lines | covered | percent";
    let mut table = Table::with_heads(
        "Lines of the library crates that their unit and integration tests run",
        columns,
    );
    let mut below = Vec::new();
    for (package, folder) in &libraries {
        let source = format!("crates/{folder}/src/");
        let own = report
            .files
            .iter()
            .filter(|file| file.path.join("/").contains(&source));
        let (covered, lines) = own.fold((0, 0), |(covered, lines), file| {
            (covered + file.covered, lines + file.coverable)
        });
        // a crate of which nothing was counted is below as well
        let percent = 100.0 * covered as f64 / (lines as f64).max(1.0);
        if percent < COVERED_PERCENT {
            below.push(package.as_str());
        }
        table.push(vec![
            package.as_str().into(),
            Cell::number(lines as f64, 0),
            Cell::number(covered as f64, 0),
            Cell::number(percent, 1),
        ])?;
    }
    output.words(format!(
        "By {version}, from the counters that the compiler puts in. Counted are the crates that others can depend on; a line \
         is covered where a test of any of them runs it. Examples, documentation tests and the command's own tests do not count."
    ));
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

/// The lists that cargo-mutants leaves of one crate.
struct Outcome {
    caught: Vec<String>,
    not_built: Vec<String>,
    timed_out: Vec<String>,
    missed: Vec<String>,
}

/// Tries every second mutant of a crate, in copies of the tree with target folders of their own.
fn try_mutants(package: &str, tests: &[&str], folder: &Path) -> Result<Outcome> {
    std::fs::create_dir_all(folder)?;
    let mut command = Command::new("cargo");
    command
        .current_dir(crate::root())
        .args(["mutants", "--package", package, "--no-shuffle"])
        .args(["--shard", SHARD, "--sharding", "round-robin"])
        .args(["--jobs", "2", "--timeout", "20", "--output"])
        .arg(folder)
        .args(tests.iter().map(|test| format!("--cargo-test-arg={test}")))
        // two jobs in one target folder would wait for each other
        .env_remove("CARGO_TARGET_DIR")
        // that a property fails is enough; its smallest case is not asked for
        .env("PROPTEST_MAX_SHRINK_ITERS", "0")
        .stdout(Stdio::null());
    let status = command.status().context("cargo mutants")?;
    // 2 where mutants were missed, 3 where tests timed out
    ensure!(
        matches!(status.code(), Some(0 | 2 | 3)),
        "cargo mutants --package {package} ended with {status}: its log is in {}",
        folder.display()
    );
    let lines = |name: &str| -> Result<Vec<String>> {
        let path = folder.join("mutants.out").join(name);
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        Ok(text.lines().map(str::to_owned).collect())
    };
    Ok(Outcome {
        caught: lines("caught.txt")?,
        not_built: lines("unviable.txt")?,
        timed_out: lines("timeout.txt")?,
        missed: lines("missed.txt")?,
    })
}

/// Writes the section of planted faults.
pub(crate) fn mutants(output: &mut Output, out: &Path) -> Result<()> {
    output.section("Planted faults");
    let Some(version) = version_of("mutants") else {
        output.words("Not run: `cargo install cargo-mutants` first.");
        return Ok(());
    };
    let text = std::fs::read_to_string(crate::root().join(EXPLAINED)).context(EXPLAINED)?;
    let explained: Survivors = toml::from_str(&text).context(EXPLAINED)?;
    let columns = "crate | mutants | caught | timed out | missed | not built";
    let mut table = Table::with_heads(
        "Every second mutant, tested with the crate's own tests",
        columns,
    );
    let (mut all, mut survivors) = (0, BTreeMap::<String, usize>::new());
    for (package, tests) in MUTATED {
        let folder = std::path::absolute(out.join("mutants").join(package))?;
        let outcome = try_mutants(package, tests, &folder)?;
        let total = outcome.caught.len() + outcome.timed_out.len() + outcome.missed.len();
        all += total;
        let counts = [
            total,
            outcome.caught.len(),
            outcome.timed_out.len(),
            outcome.missed.len(),
            outcome.not_built.len(),
        ];
        let counts = counts.map(|count| Cell::number(count as f64, 0));
        table.push([Cell::from(package)].into_iter().chain(counts).collect())?;
        for missed in &outcome.missed {
            *survivors.entry(without_place(missed)).or_default() += 1;
        }
    }
    output.words(format!(
        "By {version}: small changes to the code, each of which a test should notice. Every second of them is tried \
         (`--shard {SHARD}`), which takes a quarter of an hour on two cores. A mutant that does not build is not counted."
    ));
    output.table("mutants", table)?;
    let mut unexplained = Vec::new();
    for (name, places) in &survivors {
        let known = explained
            .survivor
            .iter()
            .find(|known| known.mutant == *name);
        let known = known.filter(|known| *places <= known.places);
        if known.is_none() {
            unexplained.push(name.as_str());
        }
        let why = known.map_or("not looked into", |known| known.why.as_str());
        output.words(format!("- survived: {name}: {why}"));
    }
    let missed: usize = survivors.values().sum();
    let percent = 100.0 * missed as f64 / (all as f64).max(1.0);
    output.verdict(
        all > 0 && percent <= SURVIVING_PERCENT,
        format!("{missed} of {all} mutants survive: {percent:.1} %, at most {SURVIVING_PERCENT} %"),
    );
    let named = if unexplained.is_empty() {
        "none".to_owned()
    } else {
        unexplained.join("; ")
    };
    output.verdict(
        unexplained.is_empty(),
        format!("survivors without an explanation in {EXPLAINED}: {named}"),
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
