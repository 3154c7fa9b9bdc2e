//! Line coverage of the tests, with a tool that must be installed.

#[cfg(unix)]
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::{MetadataCommand, Target};
use haptical_report::Table;
use serde::Deserialize;
use xtask_output::{Output, cells, or_none, read_json, root, said};

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
/// cargo-tarpaulin with its version, if it is installed.
fn version() -> Option<String> {
    let text = said(Command::new("cargo").args(["tarpaulin", "--version"])).ok()?;
    let version = text.split_whitespace().last()?;
    Some(format!("cargo-tarpaulin {version}"))
}

/// Library crates that others can depend on: package and folder, in alphabetical order.
fn libraries() -> Result<Vec<(String, String)>> {
    let metadata = MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .context("cargo metadata")?;
    let mut found = Vec::new();
    for package in &metadata.packages {
        let published = package.publish.as_ref().is_none_or(|to| !to.is_empty());
        let folder = package.manifest_path.parent();
        let folder = folder.and_then(|folder| folder.file_name());
        let is_library = published && package.targets.iter().any(Target::is_lib);
        if let Some(folder) = folder.filter(|_| is_library) {
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
        .current_dir(root())
        .args(["tarpaulin", "--engine", "llvm", "--locked", "--skip-clean"])
        // counting unoptimised code takes the tests of the diagnosis half an hour
        .args(["--no-fail-fast", "--profile", "jobs"])
        .args(["--lib", "--tests", "--timeout", SECONDS_OF_A_TEST_BINARY])
        .args(["--out", "json", "--output-dir"])
        .arg(folder)
        .arg("--target-dir")
        .arg(root().join("target/coverage"))
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
    read_json(&folder.join("tarpaulin-report.json"))
}

pub(crate) fn coverage(output: &mut Output, out: &Path) -> Result<()> {
    output.section("Line coverage");
    let Some(version) = version() else {
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
        let own = report.files.iter();
        let own = own.filter(|file| file.path.join("/").contains(&source));
        let (covered, lines) = own.fold((0, 0), |(covered, lines), file| {
            (covered + file.covered, lines + file.coverable)
        });
        // a crate of which nothing was counted is below as well
        let percent = 100.0 * covered as f64 / (lines as f64).max(1.0);
        if percent < COVERED_PERCENT {
            below.push(package.as_str());
        }
        table.push(cells! { package.as_str(), lines => 0, covered => 0, percent => 1 })?;
    }
    output.words(format!(
        "By {version}, from the counters that the compiler puts in. Counted are the crates that others can depend on; a line \
         is covered where a test of any of them runs it. Examples, documentation tests and the command's own tests do not count."
    ));
    output.table("coverage", table)?;
    let named = or_none(&below);
    let text = format!("crates below {COVERED_PERCENT} % of their lines: {named}");
    output.verdict(below.is_empty(), text);
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
