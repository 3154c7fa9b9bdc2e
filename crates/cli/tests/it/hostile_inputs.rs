//! Every file in fixtures/bad is answered as its index says, and leaves nothing behind.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::{haptical, text};

/// The fewest bad inputs; there may be more.
const FEWEST: usize = 60;

/// One table of the index.
struct Case {
    run: String,
    exit: i32,
    /// Beginnings of the three lines of a refusal.
    refusal: Option<[String; 3]>,
    /// Beginning of a warning.
    warning: Option<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/bad")
}

fn cases() -> Vec<Case> {
    let index = std::fs::read_to_string(folder().join("index.toml")).unwrap();
    let index: toml::Table = index.parse().unwrap();
    let tables = index["case"].as_array().unwrap();
    let case = |table: &toml::Value| {
        let text = |key: &str| table.get(key).map(|text| text.as_str().unwrap().to_owned());
        let lines = [text("error"), text("where"), text("next")];
        Case {
            run: text("run").unwrap(),
            exit: i32::try_from(table["exit"].as_integer().unwrap()).unwrap(),
            refusal: lines[0].is_some().then(|| lines.map(Option::unwrap)),
            warning: text("warning"),
        }
    };
    tables.iter().map(case).collect()
}

/// Names and contents of a folder, folders in it by their names alone.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read(&path).unwrap_or_default())
        })
        .collect()
}

#[test]
fn every_bad_input_is_answered_as_its_index_says() {
    let sandbox = tempfile::tempdir().unwrap();
    for (name, content) in contents(&folder()) {
        std::fs::write(sandbox.path().join(name), content).unwrap();
    }
    let before = contents(sandbox.path());
    let cases = cases();
    assert!(cases.len() >= FEWEST, "{}", cases.len());
    for case in &cases {
        let run = &case.run;
        let words = run
            .split(' ')
            .map(|word| if word == "\"\"" { "" } else { word });
        let output = haptical()
            .current_dir(sandbox.path())
            .args(words)
            .output()
            .unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(case.exit), "{run}\n{said}");
        for printed in [&said, &text(&output.stdout)] {
            assert!(!printed.contains("panicked"), "{run}\n{printed}");
            assert!(!printed.contains("NaN"), "{run}\n{printed}");
        }
        if let Some(wanted) = &case.refusal {
            assert!(output.stdout.is_empty(), "{run}");
            let lines: Vec<&str> = said.lines().collect();
            let start = lines.iter().position(|line| line.starts_with("error: "));
            let lines = &lines[start.unwrap()..];
            assert_eq!(lines.len(), 3, "{run}\n{said}");
            let names = ["error: ", "  where: ", "  next: "];
            for ((line, name), wanted) in lines.iter().zip(names).zip(wanted) {
                let rest = line.strip_prefix(name);
                let is_said = rest.is_some_and(|rest| rest.starts_with(wanted.as_str()));
                assert!(is_said, "{run}\nwanted: {name}{wanted}\n{said}");
            }
        }
        if let Some(wanted) = &case.warning {
            let is_said = said.lines().any(|line| {
                line.strip_prefix("warning: ")
                    .is_some_and(|rest| rest.starts_with(wanted.as_str()))
            });
            assert!(is_said, "{run}\nwanted: {wanted}\n{said}");
        }
        let answered = case.refusal.is_some() || case.warning.is_some();
        assert!(answered, "no answer is wanted of: {run}");
        assert!(
            contents(sandbox.path()) == before,
            "{run} wrote or changed a file"
        );
    }
}

#[test]
fn every_file_of_the_folder_is_run_and_every_run_is_another() {
    let cases = cases();
    let runs: BTreeSet<&str> = cases.iter().map(|case| case.run.as_str()).collect();
    assert_eq!(runs.len(), cases.len());
    let words: BTreeSet<&str> = runs.iter().flat_map(|run| run.split(' ')).collect();
    for name in contents(&folder()).keys() {
        let is_bad = [
            "device-", "log-", "model-", "effects-", "result-", "urdf-", "rig-",
        ]
        .iter()
        .any(|kind| name.starts_with(kind));
        assert!(
            !is_bad || words.contains(name.as_str()),
            "{name} is not in the index"
        );
    }
}

#[test]
fn an_unreadable_file_is_named() {
    let sandbox = crate::Sandbox::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        for name in ["log.csv", "device.toml"] {
            let path = sandbox.path(name);
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o0)).unwrap();
            if std::fs::File::open(&path).is_ok() {
                println!("skipped: this user reads files without permission");
                return;
            }
            let output = sandbox.identify(&[]);
            assert_eq!(output.status.code(), Some(2));
            let said = text(&output.stderr);
            assert!(
                said.contains(name) && said.contains("ermission denied"),
                "{said}"
            );
        }
    }
    drop(sandbox);
}

#[test]
fn metres_are_told_from_millimetres_by_the_reach_of_the_device() {
    let sandbox = crate::Sandbox::new();
    let cells = sandbox.cells();
    let index = crate::column(&cells, "cable_m");
    // The device reaches 1.1 m, and the middle reading is about 0.3 m.
    for (factor, status) in [(1000.0, 2), (100.0, 2), (1.0, 0)] {
        let mut changed = cells.clone();
        for row in &mut changed[1..] {
            let metres: f64 = row[index].parse().unwrap();
            row[index] = (metres * factor).to_string();
        }
        sandbox.write_log(&changed);
        let check = ["check", "device.toml", "log.csv"];
        let output = haptical()
            .current_dir(sandbox.path("."))
            .args(check)
            .output()
            .unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{factor}: {said}");
        let is_said = said.contains("`cable_m` looks like millimetres");
        assert_eq!(is_said, status == 2, "{factor}: {said}");
    }
}
