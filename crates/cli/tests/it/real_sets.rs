//! The commands of docs/guides/import-real-sets.md, where the data of others are there; otherwise the test says that it skips. The logs
//! are compared with those that other programs made of the same files, where these are there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{haptical, text};

/// Ours, and the other program's log in the folder `data`; its digits are nine at least.
const SAME: [(&str, &str); 8] = [
    ("irb120-desk.csv", "irb120-desk/point.csv"),
    ("liao-slides.csv", "liao/slides.csv"),
    ("justin-right.csv", "justin/right.csv"),
    ("justin-left.csv", "justin/left.csv"),
    ("meca-left.csv", "meca/left.csv"),
    ("meca-right.csv", "meca/right.csv"),
    ("psm-no.csv", "wpi/no.csv"),
    ("psm-no-205.csv", "wpi/no_205.csv"),
];
/// The other logs have readings of joints with ten digits, of the da Vinci with seven, its torques with six.
const RELATIVE: f64 = 5.1e-6;
const ABSOLUTE: f64 = 1e-9;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A folder of outside data, by the first part of a path in the guide.
fn outside(first: &str) -> Option<PathBuf> {
    let shared = root().join("../shared");
    match first {
        "measured" => Some(shared.join("measured")),
        "src" | "data" => Some(PathBuf::from(std::env::var_os("HAPTICAL_REAL_SETS")?).join(first)),
        "fixtures" => Some(root().join("fixtures")),
        _ => None,
    }
}

/// A word of a command with the path of what is outside; none where that is not there.
fn word(word: &str) -> Option<PathBuf> {
    let Some((first, rest)) = word.split_once('/') else {
        return Some(PathBuf::from(word));
    };
    let path = outside(first)?.join(rest);
    path.exists().then_some(path)
}

/// Columns by name: texts, row by row.
fn columns(path: &Path) -> BTreeMap<String, Vec<String>> {
    let content = std::fs::read_to_string(path).unwrap();
    let mut lines = content.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in lines {
        for (name, cell) in names.iter().zip(line.split(',')) {
            columns
                .entry((*name).to_owned())
                .or_default()
                .push(cell.to_owned());
        }
    }
    columns
}

/// The largest difference of two logs, and where it is.
fn largest_difference(
    ours: &BTreeMap<String, Vec<String>>,
    theirs: &BTreeMap<String, Vec<String>>,
) -> (f64, String) {
    let names = |columns: &BTreeMap<String, Vec<String>>| -> Vec<String> {
        columns.keys().cloned().collect()
    };
    assert_eq!(names(ours), names(theirs));
    let mut largest = (0.0, String::new());
    for (name, own) in ours {
        let other = &theirs[name];
        assert_eq!(own.len(), other.len(), "{name}");
        for (row, (own, other)) in own.iter().zip(other).enumerate() {
            let (own, other): (f64, f64) = (own.parse().unwrap(), other.parse().unwrap());
            let difference = (own - other).abs();
            let place = format!("{name}, row {}: {own} and {other}", row + 1);
            assert!(difference <= ABSOLUTE + RELATIVE * other.abs(), "{place}");
            if difference > largest.0 {
                largest = (difference, place);
            }
        }
    }
    largest
}

/// Compares a log of the guide with the one that another program made of the same files.
fn compare(folder: &Path, data: &Path, ours: &str, theirs: &str) {
    let (own, other) = (folder.join(ours), data.join(theirs));
    if !own.exists() || !other.exists() {
        println!("skipped: {ours} has nothing to be compared with");
        return;
    }
    let (mut own, mut other) = (columns(&own), columns(&other));
    if ours == "irb120-desk.csv" {
        // of three reflectors the other program took the first
        assert_eq!(own["tool"].len(), 3 * other["x_m"].len());
        own.retain(|name, _| other.contains_key(name));
        own.values_mut()
            .for_each(|cells| cells.truncate(other["x_m"].len()));
    }
    // a log of one run need not say so
    let is_one = |runs: &Vec<String>| runs.iter().all(|run| *run == runs[0]);
    if !own.contains_key("run") && other.get("run").is_some_and(is_one) {
        other.remove("run");
    }
    let (difference, place) = largest_difference(&own, &other);
    println!("{ours}: largest difference {difference:e} at {place}");
}

#[test]
fn real_sets_are_imported_by_commands_alone() {
    let guide = std::fs::read_to_string(root().join("docs/guides/import-real-sets.md")).unwrap();
    let commands = guide
        .lines()
        .filter_map(|line| line.strip_prefix("haptical "));
    let folder = tempfile::tempdir().unwrap();
    let (mut run, mut skipped) = (0, 0);
    for command in commands {
        let words: Option<Vec<PathBuf>> = command.split_whitespace().map(word).collect();
        let Some(words) = words else {
            println!("skipped, its data are not here: haptical {command}");
            skipped += 1;
            continue;
        };
        let output = haptical()
            .current_dir(folder.path())
            .args(words)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{command}\n{}",
            text(&output.stderr)
        );
        run += 1;
    }
    assert_eq!(run + skipped, 13, "commands of the guide");
    let Some(data) = outside("data") else {
        return;
    };
    for (ours, theirs) in SAME {
        compare(folder.path(), &data, ours, theirs);
    }
}
