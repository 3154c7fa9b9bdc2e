//! The same postures as other programs write them: every table gives the log that they were made from.

use std::path::{Path, PathBuf};

use haptical_tables::{Applied, Mapping, Table, apply, guess, read_table};

use crate::support::{close, column};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/tables")
        .join(name)
}

fn tables(files: &[&str], mapping: &Mapping) -> Vec<Table> {
    files
        .iter()
        .map(|file| read_table(&fixture(file), &mapping.table).unwrap())
        .collect()
}

fn imported(columns: &str, files: &[&str]) -> Applied {
    let text = std::fs::read_to_string(fixture(columns)).unwrap();
    let mapping = Mapping::from_toml(&text, columns).unwrap();
    apply(&tables(files, &mapping), &mapping).unwrap()
}

const NAMES: [&str; 13] = [
    "theta1_rad",
    "theta2_rad",
    "theta3_rad",
    "theta4_m",
    "theta5_rad",
    "theta6_rad",
    "x_m",
    "y_m",
    "z_m",
    "qw",
    "qx",
    "qy",
    "qz",
];

#[track_caller]
fn is_the_log(found: &Applied, names: &[&str], within: f64) {
    let table = read_table(&fixture("log.csv"), &Mapping::default().table).unwrap();
    for name in names {
        let wanted = table.columns[table.find(name).unwrap()]
            .cells
            .numbers()
            .unwrap();
        close(&column(found, name), wanted, within);
    }
}

/// A joint that counts from the horizontal is another one's angle more.
#[test]
fn a_pendant_with_coupled_joints() {
    let found = imported("pendant.toml", &["pendant.csv"]);
    is_the_log(&found, &NAMES, 1e-12);
    let text = std::fs::read_to_string(fixture("pendant.toml")).unwrap();
    // without the sum the third joint is another one
    let alone = Mapping::from_toml(&text.replace("plus = \"J2\"\n", ""), "pendant.toml").unwrap();
    let log = apply(&tables(&["pendant.csv"], &alone), &alone).unwrap();
    let (sum, alone) = (column(&found, "theta3_rad"), column(&log, "theta3_rad"));
    let second = column(&found, "theta2_rad");
    for ((sum, alone), second) in sum.iter().zip(&alone).zip(&second) {
        assert!((sum - alone - second).abs() < 1e-12);
    }
    for (from, to, what) in [
        ("plus = \"J2\"", "plus = \"J2\"\nplus_factor = -1", None),
        (
            "plus = \"J2\"",
            "plus_factor = 2",
            Some("has plus_factor and no `plus`"),
        ),
        (
            "factor = -1",
            "factor = -1\nplus = \"J2\"",
            Some("give each its own [[column]]"),
        ),
    ] {
        let read = Mapping::from_toml(&text.replacen(from, to, 1), "pendant.toml");
        match what {
            None => assert!(read.is_ok()),
            Some(what) => assert!(read.unwrap_err().what.contains(what), "{to}"),
        }
    }
}

#[test]
fn a_controller_s_protocol() {
    is_the_log(&imported("protocol.toml", &["protocol.txt"]), &NAMES, 1e-12);
}

#[test]
fn two_files_by_time() {
    is_the_log(
        &imported("time.toml", &["joints.csv", "tracker.csv"]),
        &NAMES,
        1e-12,
    );
}

#[cfg(feature = "archives")]
#[test]
fn arrays_of_numpy() {
    is_the_log(
        &imported("numpy.toml", &["joints.npy", "poses.npz"]),
        &NAMES,
        1e-12,
    );
}

#[test]
fn arrays_of_matlab() {
    is_the_log(&imported("matlab.toml", &["arm.mat"]), &NAMES, 1e-12);
}

#[cfg(feature = "archives")]
#[test]
fn a_spreadsheet() {
    is_the_log(&imported("sheet.toml", &["poses.xlsx"]), &NAMES, 1e-12);
}

/// Half a count of 20000 in a turn.
#[test]
fn counts_of_encoders() {
    let found = imported("counts.toml", &["counts.dat"]);
    is_the_log(
        &found,
        &NAMES[..6],
        0.5001 * std::f64::consts::TAU / 20000.0,
    );
    is_the_log(&found, &NAMES[6..9], 5.1e-7);
}

/// The proposals for these files, with the device's joints, need no correction but where they say so.
#[test]
fn proposals_are_right_where_the_files_say_enough() {
    let joints = [
        "shoulder_pan",
        "shoulder_lift",
        "elbow",
        "extension",
        "wrist_roll",
        "wrist_bend",
    ];
    let joints: Vec<(String, bool)> = joints
        .iter()
        .map(|name| ((*name).to_owned(), *name == "extension"))
        .collect();
    let proposed = |files: &[&str]| {
        let read = tables(files, &Mapping::default());
        let text = guess(&read, &joints);
        let mapping = Mapping::from_toml(&text, "columns.toml")
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        (
            apply(&tables(files, &mapping), &mapping)
                .unwrap_or_else(|error| panic!("{error}\n{text}")),
            text,
        )
    };
    let (found, text) = proposed(&["joints.csv", "tracker.csv"]);
    is_the_log(&found, &NAMES[..6], 1e-12);
    assert!(
        text.contains("match = \"time\"") && text.contains("time_unit = [\"ms\", \"s\"]"),
        "{text}"
    );
    assert!(
        text.contains("rotation_vector") && text.contains("UNSURE"),
        "{text}"
    );
    let (found, text) = proposed(&["protocol.txt"]);
    is_the_log(&found, &NAMES[..9], 1e-12);
    assert!(
        text.contains("decimal = \",\"") && text.contains("thousands"),
        "{text}"
    );
    // KUKA's A, B and C
    is_the_log(&found, &NAMES[9..], 5e-9);
    is_the_log(&proposed(&["arm.mat"]).0, &NAMES, 1e-12);
    #[cfg(feature = "archives")]
    {
        is_the_log(&proposed(&["poses.xlsx"]).0, &NAMES, 1e-12);
    }
}
