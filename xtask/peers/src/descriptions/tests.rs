//! The job on two small descriptions, and its verdicts.

use std::path::{Path, PathBuf};

use super::ask::versions;
use super::compared;
use super::files::find;
use super::findings::{Finding, Part, Row, State, Verdict, Worst};
use super::table::{silent, table};

/// A Python with both peers: that of the environment, or the system's.
fn python() -> Option<PathBuf> {
    let named = std::env::var_os("HAPTICAL_PEERS_PYTHON").map(PathBuf::from);
    let python = named.unwrap_or_else(|| PathBuf::from("python3"));
    match versions(&python) {
        Ok(_) => Some(python),
        Err(error) => {
            println!("skipped: {error:#}");
            None
        }
    }
}

#[test]
fn two_fixtures_are_equal_to_their_peers() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dynamics/described");
    let Some(python) = python() else {
        return;
    };
    let found = find(&fixtures).unwrap();
    let out = tempfile::tempdir().unwrap();
    let rows = compared(&python, out.path(), &found).unwrap();
    let text = table(&rows);
    assert_eq!(rows.len(), 2, "{text}");
    assert_eq!(silent(&rows), Vec::<String>::new(), "{text}");
    for row in &rows {
        assert_eq!(row.joints, 4, "{text}");
        assert!(row.worst().torque.is_some_and(|own| own < 1e-9), "{text}");
    }
}

/// What a file holds that haptical does not name ends in a silent difference, however equal the rest is.
#[test]
fn one_difference_decides() {
    let equal = State::Equal(Worst {
        pose: Some(1e-15),
        torque: None,
    });
    let finding = |state: State| Finding {
        part: Part::Given,
        with: "mujoco".to_owned(),
        state,
    };
    let mut row = Row {
        file: "arm.xml".to_owned(),
        joints: 2,
        findings: Vec::new(),
    };
    row.add(finding(State::PeerRefused("no mass".to_owned())));
    assert_eq!(row.verdict().0, Verdict::PeerRefused);
    row.add(finding(equal));
    assert_eq!(row.verdict().0, Verdict::Equal);
    row.add(finding(State::Said("left out".to_owned())));
    assert_eq!(row.verdict(), (Verdict::Said, "left out".to_owned()));
    let words = "springs (1.0e0) of mujoco is not said".to_owned();
    row.add(finding(State::Different(Worst::default(), words.clone())));
    assert_eq!(row.verdict(), (Verdict::Different, words.clone()));
    assert_eq!(silent(&[row]), [format!("silent: arm.xml: {words}")]);
}
