//! The seed of a batch: a number while developing, the commit that froze the thresholds for a scored one.

use std::path::Path;
use std::process::Command;
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use chrono::Utc;
use serde::Serialize;
use xtask_output::said;

/// The thresholds of every crate, from the root of the repository.
const THRESHOLDS: [&str; 2] = [
    ":(glob)crates/*/src/thresholds.rs",
    ":(glob)crates/*/src/thresholds/*.rs",
];
/// What is handed a recording: it and every crate that it depends on can change a verdict.
const JUDGE: &str = "diagnosis";
/// What says with which dependencies and at which optimisation the judge is built, from the root of the repository.
const BUILD: [&str; 2] = ["Cargo.lock", "Cargo.toml"];
/// What makes the recordings.
const GENERATOR: &str = "xtask/blind/src";
/// Hexadecimal digits of the commit that make the seed.
const DIGITS: usize = 8;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SeedRule {
    /// This number.
    Number(u64),
    /// The first digits of the commit that last changed the thresholds.
    Commit,
}

impl FromStr for SeedRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "commit" {
            return Ok(Self::Commit);
        }
        let number = text.parse().map(Self::Number);
        number.map_err(|_| format!("`{text}` is neither a number nor `commit`"))
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Seed {
    pub(crate) value: u64,
    /// The commit that froze the thresholds, where the seed is its first digits.
    pub(crate) frozen_by: Option<String>,
    /// Commits that changed the diagnosis after that one.
    pub(crate) changes_since: usize,
}

impl SeedRule {
    /// The seed; `root` is the repository.
    pub(crate) fn seed(self, root: &Path) -> Result<Seed> {
        match self {
            Self::Number(value) => Ok(Seed {
                value,
                frozen_by: None,
                changes_since: 0,
            }),
            Self::Commit => of_commit(root),
        }
    }
}

fn of_commit(root: &Path) -> Result<Seed> {
    let judged = judged(root);
    let with_paths = |words: &[&'static str], further: &[&'static str]| -> Vec<String> {
        let words = words.iter().chain(further).map(|&word| word.to_owned());
        words.chain(judged.iter().cloned()).collect()
    };
    let status = with_paths(&["status", "--porcelain", "--"], &[GENERATOR]);
    let changed = git(root, &status)?;
    ensure!(
        changed.is_empty(),
        "--seed commit needs these committed, for a scored batch is one that can be repeated:\n{changed}"
    );
    let last = [&["log", "-1", "--format=%H", "--"][..], &THRESHOLDS].concat();
    let commit = git(root, &last)?;
    let Some(digits) = commit.get(..DIGITS) else {
        bail!("--seed commit: no commit has changed crates/*/src/thresholds.rs");
    };
    let value = u64::from_str_radix(digits, 16)
        .with_context(|| format!("`{commit}` is not the name of a commit"))?;
    let since = format!("{commit}..HEAD");
    let log = ["log", "--format=%H", &since, "--"].map(str::to_owned);
    let log: Vec<String> = log.into_iter().chain(judged).collect();
    let changes = git(root, &log)?;
    Ok(Seed {
        value,
        frozen_by: Some(commit),
        changes_since: changes.lines().count(),
    })
}

/// What can change a verdict: sources and manifests of the judge and of every crate of ours among its dependencies and theirs, and
/// the versions of all others.
pub(crate) fn judged(root: &Path) -> Vec<String> {
    let mut names = vec![JUDGE.to_owned()];
    let mut index = 0;
    while let Some(name) = names.get(index) {
        index += 1;
        // a crate without a manifest has no dependencies
        let manifest = root.join("crates").join(name).join("Cargo.toml");
        let manifest = std::fs::read_to_string(manifest).unwrap_or_default();
        let lines = manifest
            .lines()
            .skip_while(|line| *line != "[dependencies]")
            .skip(1);
        for line in lines.take_while(|line| !line.starts_with('[')) {
            let Some(other) = line.strip_prefix("haptical-") else {
                continue;
            };
            let other = other.split(['.', ' ', '=']).next().unwrap_or(other);
            if !names.iter().any(|name| name == other) {
                names.push(other.to_owned());
            }
        }
    }
    names
        .iter()
        .flat_map(|name| ["src", "Cargo.toml"].map(|file| format!("crates/{name}/{file}")))
        .chain(BUILD.map(str::to_owned))
        .collect()
}

/// The commit at hand, in short, and whether files differ from it; `none` outside a repository.
pub(crate) fn head(root: &Path) -> String {
    let Ok(commit) = git(root, &["rev-parse", "--short=8", "HEAD"]) else {
        return "none".to_owned();
    };
    let status = ["status", "--porcelain", "--", "crates", "Cargo.lock"];
    match git(root, &status) {
        Ok(changes) if changes.is_empty() => commit,
        _ => format!("{commit} with changes"),
    }
}

/// Today in universal time, YYYY-MM-DD.
pub(crate) fn today() -> String {
    Utc::now().date_naive().to_string()
}

fn git<S: AsRef<str>>(root: &Path, arguments: &[S]) -> Result<String> {
    let arguments = arguments.iter().map(AsRef::as_ref);
    said(Command::new("git").arg("-C").arg(root).args(arguments))
}
