//! The seed of a scored batch in a repository made for the purpose; the log.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use crate::report::bars::measures;
use crate::report::record::{LOG, Run, headlines, row, with_row};
use crate::root;
use crate::seed::{SeedRule, head};

const THRESHOLDS: &str = "crates/motion/src/thresholds.rs";

fn git(root: &Path, words: &[&str]) -> String {
    let identity = [
        "-c",
        "user.name=a",
        "-c",
        "user.email=a@b.c",
        "-c",
        "commit.gpgsign=false",
    ];
    let output = Command::new("git")
        .arg("-C")
        .arg(root)
        .args(identity)
        .args(words)
        .output()
        .unwrap();
    assert!(output.status.success(), "git {words:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

fn write(root: &Path, path: &str, text: &str) {
    let path = root.join(path);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

fn commit(root: &Path, message: &str) -> String {
    git(root, &["add", "-A"]);
    git(root, &["commit", "-q", "-m", message]);
    git(root, &["rev-parse", "HEAD"])
}

#[test]
fn the_seed_is_the_commit_that_froze_the_thresholds() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    git(root, &["init", "-q"]);
    write(root, "crates/diagnosis/src/lib.rs", "a");
    commit(root, "code");
    let refused = SeedRule::Commit.seed(root).expect_err("no thresholds yet");
    assert!(refused.to_string().contains("thresholds"), "{refused}");

    write(root, THRESHOLDS, "z = 1");
    let frozen = commit(root, "thresholds");
    let seed = SeedRule::Commit.seed(root).unwrap();
    assert_eq!(format!("{:08x}", seed.value), frozen[..8]);
    assert_eq!(
        (seed.frozen_by, seed.changes_since),
        (Some(frozen.clone()), 0)
    );

    write(root, "README.md", "unrelated");
    commit(root, "words");
    write(root, "crates/effects/src/lib.rs", "b");
    commit(root, "code that nothing judges by");
    let same = SeedRule::Commit.seed(root).unwrap();
    assert_eq!((same.value, same.changes_since), (seed.value, 0));

    write(
        root,
        "crates/diagnosis/Cargo.toml",
        "[dependencies]\nhaptical-effects.workspace = true\n",
    );
    write(root, "crates/effects/src/lib.rs", "c");
    commit(root, "more code");
    let later = SeedRule::Commit.seed(root).unwrap();
    // the crate counts now, and so does what was changed in it before
    assert_eq!((later.value, later.changes_since), (seed.value, 2));

    write(root, THRESHOLDS, "z = 2");
    let again = commit(root, "other thresholds");
    let other = SeedRule::Commit.seed(root).unwrap();
    assert_eq!((other.frozen_by, other.changes_since), (Some(again), 0));
}

#[test]
fn a_scored_batch_needs_everything_committed() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    git(root, &["init", "-q"]);
    write(root, THRESHOLDS, "z = 1");
    write(root, "crates/diagnosis/src/lib.rs", "a");
    write(root, "crates/effects/src/lib.rs", "a");
    write(root, "xtask/blind/src/lib.rs", "a");
    write(root, "docs/note.md", "a");
    let manifest = "[package]\nname = \"haptical-diagnosis\"\n[dependencies]\nhaptical-effects.workspace = true\n\
                    haptical-motion = { path = \"../motion\" }\nserde = \"1\"\n[dev-dependencies]\nhaptical-data.workspace = true\n";
    write(root, "crates/diagnosis/Cargo.toml", manifest);
    write(
        root,
        "crates/motion/Cargo.toml",
        "[dependencies]\nhaptical-dynamics.workspace = true\n",
    );
    write(root, "crates/dynamics/src/lib.rs", "a");
    commit(root, "all");
    write(root, "docs/note.md", "b");
    let commit = git(root, &["rev-parse", "--short=8", "HEAD"]);
    assert_eq!(head(root), commit, "a note changes no answer");
    write(root, "crates/data/src/lib.rs", "new");
    assert_eq!(head(root), format!("{commit} with changes"));
    assert!(
        SeedRule::Commit.seed(root).is_ok(),
        "what its tests alone need is not judged"
    );
    for path in [
        THRESHOLDS,
        "crates/diagnosis/src/lib.rs",
        "crates/diagnosis/src/new.rs",
        "crates/effects/src/lib.rs",
        "crates/motion/src/lib.rs",
        "crates/dynamics/src/lib.rs",
        "crates/dynamics/Cargo.toml",
        "Cargo.lock",
        "xtask/blind/src/lib.rs",
    ] {
        write(root, path, "changed");
        let refused = SeedRule::Commit.seed(root).expect_err(path).to_string();
        assert!(refused.contains(path), "{path}: {refused}");
        git(root, &["add", "-A"]);
        assert!(
            SeedRule::Commit.seed(root).is_err(),
            "{path}: staged is not committed"
        );
        git(root, &["reset", "-q", "--hard"]);
    }
    let number = SeedRule::Number(7).seed(Path::new("/nowhere")).unwrap();
    assert_eq!((number.value, number.frozen_by), (7, None));
}

fn run(seed: u64) -> Run {
    Run {
        date: "2026-01-02".to_owned(),
        commit: "0123abcd".to_owned(),
        frozen_by: "deadbeef".to_owned(),
        seed,
        changes_since: 2,
        counts: "s0 300".to_owned(),
    }
}

#[test]
fn a_run_is_one_row_of_the_log() {
    let log = std::fs::read_to_string(root().join(LOG)).unwrap();
    let none = measures(&[]);
    let first = row(&log, &run(u64::MAX), &none).unwrap();
    assert!(first.contains("first with this seed"), "{first}");
    assert!(first.contains("2 commits changed the diagnosis"), "{first}");
    let head = log
        .lines()
        .find(|line| line.starts_with("| date |"))
        .expect("a table of runs");
    assert_eq!(first.matches('|').count(), head.matches('|').count());

    let longer = with_row(&log, &first).unwrap();
    assert_eq!(longer.lines().count(), log.lines().count() + 1);
    let at = |wanted: &str| longer.lines().position(|line| line == wanted).unwrap();
    let (end, mine) = (at("<!-- end of scored runs -->"), at(&first));
    assert_eq!(mine + 1, end, "the last row of the table");

    let second = row(&longer, &run(u64::MAX), &none).unwrap();
    assert!(second.contains("seed used before"), "{second}");
    assert!(with_row("no marker", &first).is_err());
    assert!(with_row(&format!("{log}{log}"), &first).is_err());
}

/// A headline names a figure that exists, by its exact name.
#[test]
fn headlines_are_among_the_figures() {
    let all = measures(&[]);
    for [group, name, _] in headlines() {
        let found = all
            .iter()
            .filter(|one| one.group == group && one.name == name);
        assert_eq!(found.count(), 1, "{group}: {name}");
    }
}

/// The list of arrows is what a test of the architecture compares with the manifests as cargo reads them.
#[test]
fn every_crate_below_the_diagnosis_is_guarded() {
    let page = std::fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let list = page
        .split("\n## ")
        .find(|part| part.starts_with("Allowed arrows"));
    let arrows: BTreeMap<&str, &str> = (list.unwrap().lines())
        .filter_map(|line| line.split_once(" -> "))
        .collect();
    let mut below = vec!["haptical-diagnosis"];
    let mut index = 0;
    while let Some(name) = below.get(index) {
        index += 1;
        let names = arrows.get(name).into_iter().flat_map(|to| to.split(", "));
        for name in names {
            if !below.contains(&name) {
                below.push(name);
            }
        }
    }
    assert!(below.len() > 8, "{below:?}");
    let mut expected = vec!["Cargo.lock".to_owned(), "Cargo.toml".to_owned()];
    for name in below {
        let folder = name.replacen("haptical-", "crates/", 1);
        expected.extend([format!("{folder}/Cargo.toml"), format!("{folder}/src")]);
    }
    expected.sort();
    let mut judged = crate::seed::judged(&root());
    judged.sort();
    assert_eq!(judged, expected);
}
