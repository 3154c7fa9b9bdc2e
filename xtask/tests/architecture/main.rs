//! The rules of docs/architecture.md that a program can check.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod files;
mod modules;
mod names;
mod numbers;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use cargo_metadata::{Dependency, DependencyKind, MetadataCommand, Package};

/// Crates that build without std and without an allocator.
const WITHOUT_STD: [&str; 4] = [
    "haptical-dynamics",
    "haptical-kinematics",
    "haptical-runtime",
    "haptical-transmission",
];
/// Dependencies of those whose default features are known not to bring std.
const DEFAULTS_WITHOUT_STD: [&str; 3] = ["haptical-kinematics", "haptical-transmission", "libm"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .canonicalize()
        .unwrap()
}

fn read(path: &str) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The packages of the workspace.
fn packages() -> Vec<Package> {
    let metadata = MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .unwrap();
    assert!(
        metadata.packages.len() > 10,
        "the workspace has lost its crates"
    );
    metadata.packages
}

/// Crate by crate, which others it may depend on.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// The list in the first code block under a heading of docs/architecture.md.
fn listed(heading: &str) -> Arrows {
    let text = read("docs/architecture.md");
    let lines: Vec<&str> = text
        .lines()
        .skip_while(|line| *line != format!("## {heading}"))
        .skip_while(|line| *line != "```text")
        .skip(1)
        .take_while(|line| *line != "```")
        .collect();
    assert!(
        !lines.is_empty(),
        "docs/architecture.md has no list under {heading}"
    );
    assert!(
        lines.is_sorted(),
        "{heading}: the crates are not in alphabetical order"
    );
    let mut arrows = Arrows::new();
    for line in lines {
        let (from, to) = line
            .split_once("->")
            .unwrap_or_else(|| panic!("no arrow in `{line}`"));
        let to: Vec<String> = to
            .split(',')
            .map(|name| name.trim().to_owned())
            .filter(|name| !name.is_empty())
            .collect();
        assert!(to.is_sorted(), "`{line}` is not in alphabetical order");
        let before = arrows.insert(from.trim().to_owned(), to.into_iter().collect());
        assert!(before.is_none(), "{from} is listed twice under {heading}");
    }
    arrows
}

/// The crates of ours among the dependencies of these kinds.
fn arrows(packages: &[Package], kinds: &[DependencyKind]) -> Arrows {
    let ours: BTreeSet<String> = packages
        .iter()
        .map(|package| package.name.to_string())
        .collect();
    packages
        .iter()
        .map(|package| {
            let to = package
                .dependencies
                .iter()
                .filter(|dependency| kinds.contains(&dependency.kind))
                .map(|dependency| dependency.name.clone())
                .filter(|name| ours.contains(name))
                .collect();
            (package.name.to_string(), to)
        })
        .collect()
}

fn package<'p>(packages: &'p [Package], name: &str) -> &'p Package {
    packages
        .iter()
        .find(|package| package.name.as_str() == name)
        .unwrap_or_else(|| panic!("no crate {name}"))
}

fn normal(package: &Package) -> impl Iterator<Item = &Dependency> {
    package
        .dependencies
        .iter()
        .filter(|dependency| dependency.kind == DependencyKind::Normal)
}

/// Every `.rs` file below a folder; none if there is no such folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

#[test]
fn dependencies_are_the_allowed_arrows() {
    let kinds = [DependencyKind::Normal, DependencyKind::Build];
    let (found, allowed) = (arrows(&packages(), &kinds), listed("Allowed arrows"));
    for (name, to) in &found {
        let expected = allowed
            .get(name)
            .unwrap_or_else(|| panic!("{name} is not in the list"));
        assert_eq!(
            to, expected,
            "dependencies of {name} (left) and the list (right)"
        );
    }
    assert_eq!(
        found, allowed,
        "the list has a crate that the workspace has not"
    );
}

#[test]
fn dependencies_of_tests_are_allowed() {
    let allowed = listed("Allowed in tests");
    let found = arrows(&packages(), &[DependencyKind::Development]);
    for (name, to) in &found {
        for dependency in to {
            let listed = allowed.get(name).is_some_and(|to| to.contains(dependency));
            assert!(
                listed,
                "{name} -> {dependency} is not under Allowed in tests"
            );
        }
    }
    for (name, to) in &allowed {
        assert_eq!(
            found.get(name),
            Some(to),
            "{name}: the list has what the manifest has not"
        );
    }
}

#[test]
fn the_picture_shows_the_list() {
    let full = |name: &str| match name.trim() {
        "haptical" => "haptical".to_owned(),
        name => format!("haptical-{name}"),
    };
    let mut drawn = Arrows::new();
    let text = read("docs/architecture.md");
    for line in text
        .lines()
        .skip_while(|line| *line != "```mermaid")
        .take_while(|line| *line != "```")
    {
        if let Some((from, to)) = line.split_once(" --> ") {
            drawn.insert(full(from), to.split('&').map(full).collect());
        }
    }
    let mut list = listed("Allowed arrows");
    list.retain(|name, to| !name.starts_with("xtask") && !to.is_empty());
    assert_eq!(drawn, list, "the flowchart (left) and the list (right)");
}

#[test]
fn arrows_make_no_circle() {
    let mut left = listed("Allowed arrows");
    while !left.is_empty() {
        let done: Vec<String> = left
            .iter()
            .filter(|(_, to)| to.iter().all(|name| !left.contains_key(name)))
            .map(|(name, _)| name.clone())
            .collect();
        assert!(!done.is_empty(), "a circle among {left:?}");
        left.retain(|name, _| !done.contains(name));
    }
}

/// Crates of ours that a crate uses, directly or through others, in its tests too.
fn reached(packages: &[Package], from: &str) -> BTreeSet<String> {
    let kinds = [DependencyKind::Normal, DependencyKind::Build];
    let (arrows, in_tests) = (
        arrows(packages, &kinds),
        arrows(packages, &[DependencyKind::Development]),
    );
    let mut open: Vec<&String> = arrows[from].iter().chain(&in_tests[from]).collect();
    let mut found = BTreeSet::new();
    while let Some(name) = open.pop() {
        if found.insert(name.clone()) {
            open.extend(&arrows[name]);
        }
    }
    found
}

/// Whoever judges a diagnosis has laws of his own: neither side has seen the other's.
#[test]
fn the_diagnosis_and_its_trials_have_laws_of_their_own() {
    let packages = packages();
    for (from, unseen) in [
        ("haptical-diagnosis", ["haptical-simulator", "xtask-blind"]),
        ("haptical-effects", ["haptical-simulator", "xtask-blind"]),
        ("xtask-blind", ["haptical-effects", "haptical-diagnosis"]),
    ] {
        let reached = reached(&packages, from);
        for name in unseen {
            package(&packages, name);
            assert!(!reached.contains(name), "{from} reaches {name}");
        }
    }
}

#[test]
fn faer_is_known_to_one_crate() {
    let users: Vec<String> = packages()
        .iter()
        .filter(|package| {
            package
                .dependencies
                .iter()
                .any(|dependency| dependency.name == "faer")
        })
        .map(|package| package.name.to_string())
        .collect();
    assert_eq!(users, ["haptical-linalg"]);
}

#[test]
fn four_crates_are_without_std() {
    let packages = packages();
    for name in WITHOUT_STD {
        let package = package(&packages, name);
        assert!(
            package.features.is_empty(),
            "{name} has features: {:?}",
            package.features
        );
        for dependency in normal(package) {
            let what = format!("{name} -> {}", dependency.name);
            assert!(
                !dependency
                    .features
                    .iter()
                    .any(|f| f == "std" || f == "alloc"),
                "{what}"
            );
            let defaults = dependency.uses_default_features;
            let harmless = DEFAULTS_WITHOUT_STD.contains(&dependency.name.as_str());
            assert!(!defaults || harmless, "{what} has its default features on");
        }
        let library = package.manifest_path.with_file_name("src").join("lib.rs");
        let text = std::fs::read_to_string(&library).unwrap();
        assert!(text.lines().any(|line| line == "#![no_std]"), "{library}");
        for file in rust_files(library.parent().unwrap().as_std_path()) {
            let text = std::fs::read_to_string(&file).unwrap();
            for word in ["extern crate std", "extern crate alloc"] {
                assert!(!text.contains(word), "{}: {word}", file.display());
            }
        }
    }
}

#[test]
fn examples_use_what_their_crate_uses() {
    let packages = packages();
    for package in &packages {
        let mut known: BTreeSet<String> =
            normal(package).map(|d| d.name.replace('-', "_")).collect();
        known.insert(package.name.replace('-', "_"));
        let folder = package.manifest_path.with_file_name("examples");
        for file in rust_files(folder.as_std_path()) {
            let text = std::fs::read_to_string(&file).unwrap();
            for other in packages
                .iter()
                .map(|package| package.name.replace('-', "_"))
            {
                let used = text.contains(&format!("{other}::"));
                assert!(
                    !used || known.contains(&other),
                    "{} uses {other}",
                    file.display()
                );
            }
        }
    }
}

/// Every crate from outside that a manifest names has a line in docs/dependencies.md, and every line names such a crate.
#[test]
fn every_dependency_has_its_reason() {
    let used: BTreeSet<String> = packages()
        .iter()
        .flat_map(|package| &package.dependencies)
        .filter(|dependency| dependency.path.is_none())
        .map(|dependency| dependency.name.clone())
        .collect();
    let page = read("docs/dependencies.md");
    let rows = page.lines().filter_map(|line| line.strip_prefix("| "));
    let names = rows.filter_map(|row| row.split(" | ").next());
    let told: BTreeSet<String> = names
        .flat_map(|names| names.split(", "))
        .filter(|name| *name != "dependency" && !name.starts_with("---"))
        .map(str::to_owned)
        .collect();
    // named in the manifest of a job alone, to build another crate's features once
    let not_used = BTreeSet::from(["libc".to_owned()]);
    let untold: Vec<&String> = used
        .difference(&told)
        .filter(|name| !not_used.contains(*name))
        .collect();
    let idle: Vec<&String> = told.difference(&used).collect();
    assert!(untold.is_empty(), "without a reason: {untold:?}");
    assert!(idle.is_empty(), "told, and used nowhere: {idle:?}");
}
