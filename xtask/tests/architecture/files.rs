//! Rules about files: their first line, length, licences, copies, versions.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::{package, packages, read, root, rust_files};

/// Hard limit of a source file.
const LONGEST_FILE_LINES: usize = 600;
/// Most files of a source folder of the jobs; folders of tests excepted.
const MOST_FILES: usize = 15;

#[test]
fn files_say_what_they_are_for_and_stay_short() {
    let mut seen = 0;
    for package in &packages() {
        let folder = package.manifest_path.with_file_name("src");
        for file in rust_files(folder.as_std_path()) {
            let text = std::fs::read_to_string(&file).unwrap();
            let first = text.lines().next().unwrap_or_default();
            let said = first.starts_with("//!") || first.starts_with("#![doc");
            assert!(said, "{} does not start with `//!`", file.display());
            let lines = text.lines().count();
            assert!(
                lines <= LONGEST_FILE_LINES,
                "{} has {lines} lines",
                file.display()
            );
            seen += 1;
        }
    }
    assert!(seen > 50, "only {seen} files were seen");
}

/// A library that says `test = false` or `doctest = false` has no test or example that would be passed over.
#[test]
fn no_test_is_passed_over() {
    let mut seen = 0;
    for package in &packages() {
        let Some(library) = package.targets.iter().find(|target| target.is_lib()) else {
            continue;
        };
        for file in rust_files(package.manifest_path.with_file_name("src").as_std_path()) {
            let text = std::fs::read_to_string(&file).unwrap();
            let has_tests = text.contains("#[test]") || text.contains("#[cfg(test)]");
            let has_examples = text.lines().any(|line| {
                let line = line.trim_start();
                line.starts_with("/// ```") || line.starts_with("//! ```")
            });
            assert!(
                (library.test || !has_tests) && (library.doctest || !has_examples),
                "{} is passed over",
                file.display()
            );
        }
        seen += usize::from(!library.test);
    }
    assert!(seen > 0, "every library has a harness");
}

#[test]
fn source_folders_are_small() {
    for package in packages()
        .iter()
        .filter(|package| package.name.starts_with("xtask"))
    {
        let mut folders: BTreeMap<PathBuf, usize> = BTreeMap::new();
        for file in rust_files(package.manifest_path.with_file_name("src").as_std_path()) {
            let folder = file.parent().unwrap().to_path_buf();
            if !folder.ends_with("tests") {
                *folders.entry(folder).or_insert(0) += 1;
            }
        }
        for (folder, files) in folders {
            assert!(files <= MOST_FILES, "{}: {files} files", folder.display());
        }
    }
}

#[test]
fn every_published_crate_carries_its_licences_and_a_readme() {
    for package in packages()
        .iter()
        .filter(|package| package.publish.as_ref().is_none_or(|to| !to.is_empty()))
    {
        for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let copy = std::fs::read_to_string(package.manifest_path.with_file_name(name));
            let copy = copy.unwrap_or_else(|error| panic!("{}: {name}: {error}", package.name));
            assert_eq!(copy, read(name), "{}: {name}", package.name);
        }
        let readme = package.manifest_path.with_file_name("README.md");
        let text = std::fs::read_to_string(&readme).unwrap();
        assert!(text.starts_with("# haptical"), "{readme}");
    }
}

#[test]
fn the_toolchain_is_the_user_s() {
    for name in ["rust-toolchain.toml", "rust-toolchain"] {
        assert!(
            !root().join(name).exists(),
            "{name}: rust-version in Cargo.toml is enough"
        );
    }
}

/// A fixture and the file outside the project that it is a copy of.
fn same_as_outside(fixture: &str, outside: &str) {
    let outside = root().join("..").join("shared").join(outside);
    if !outside.exists() {
        println!("skipped: {fixture} has nothing outside the project to be compared with");
        return;
    }
    let outside = std::fs::read_to_string(outside).unwrap();
    assert!(
        read(fixture) == outside,
        "{fixture} is not the file that it is a copy of"
    );
}

#[test]
fn the_paper_s_tables_are_the_ones_given() {
    same_as_outside("fixtures/paper/tables.toml", "paper/data.toml");
}

#[test]
fn the_device_is_the_one_given() {
    same_as_outside("fixtures/devices/haptic7.toml", "devices/haptic7.toml");
}

#[test]
fn rust_versions_agree() {
    let packages = packages();
    let version = package(&packages, "haptical-model")
        .rust_version
        .clone()
        .unwrap();
    let version = format!("{}.{}", version.major, version.minor);
    for other in [
        "outside/controller/Cargo.toml",
        "outside/control-loop/Cargo.toml",
        "outside/user/Cargo.toml",
    ] {
        let line = format!("rust-version = \"{version}\"");
        assert!(
            read(other).lines().any(|found| found == line),
            "{other}: no {line}"
        );
    }
    let readme = root().join("README.md");
    if !readme.exists() {
        println!("skipped: {} is absent", readme.display());
        return;
    }
    for found in rust_versions_in(&std::fs::read_to_string(readme).unwrap()) {
        assert_eq!(found, version, "README.md (left) and Cargo.toml (right)");
    }
}

/// `1.90` from `Rust 1.90`, `rustc 1.90.0`, `rust-1.90+` and the like.
fn rust_versions_in(text: &str) -> Vec<String> {
    let lower = text.to_lowercase();
    let mut found = Vec::new();
    for (at, _) in lower.match_indices("1.") {
        let before = lower[..at].trim_end_matches([' ', '-', '*', '`', '"', '=']);
        let minor: String = lower[at + 2..]
            .chars()
            .take_while(char::is_ascii_digit)
            .collect();
        let named = ["rust", "rustc", "rust-version"]
            .iter()
            .any(|name| before.ends_with(name));
        if named && !minor.is_empty() {
            found.push(format!("1.{minor}"));
        }
    }
    found
}

#[test]
fn a_rust_version_is_found_in_prose() {
    let text =
        "Needs Rust 1.90 or later (`rust-version = \"1.91\"`, rustc 1.92.0); 1.5 mm, trust 11.2.";
    assert_eq!(rust_versions_in(text), ["1.90", "1.91", "1.92"]);
}
