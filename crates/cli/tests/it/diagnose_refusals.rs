//! What `haptical diagnose` refuses, with which exit status, and that it then writes nothing.

use crate::{Sandbox, column, names_in, text};

/// Runs diagnose, plain and with --json: exit status, the three lines, their JSON form, no files.
/// `wanted` are texts that the message must hold.
fn refused(sandbox: &Sandbox, further: &[&str], status: i32, wanted: &[&str]) {
    let plain = sandbox.diagnose(further);
    let message = text(&plain.stderr);
    assert_eq!(plain.status.code(), Some(status), "{message}");
    assert!(plain.stdout.is_empty());
    let lines: Vec<&str> = message.lines().collect();
    let start = lines.iter().position(|line| line.starts_with("error: "));
    let [error, place, next] = lines[start.unwrap()..] else {
        panic!("not three lines: {message}");
    };
    assert!(error.len() > "error: ".len(), "{message}");
    assert!(
        place.starts_with("  where: ") && next.starts_with("  next: "),
        "{message}"
    );
    for wanted in wanted {
        assert!(message.contains(wanted), "`{wanted}` is not in: {message}");
    }
    let json = sandbox.diagnose(&[further, &["--json"]].concat());
    assert_eq!(json.status.code(), Some(status));
    let object: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let said = &object["error"];
    assert_eq!(format!("error: {}", said["what"].as_str().unwrap()), error);
    assert_eq!(
        format!("  where: {}", said["where"].as_str().unwrap()),
        place
    );
    assert_eq!(format!("  next: {}", said["next"].as_str().unwrap()), next);
    assert_eq!(names_in(&sandbox.path("result")), Vec::<String>::new());
}

#[test]
fn an_unknown_effect_is_answered_with_the_nearest_name() {
    let sandbox = Sandbox::new();
    let wanted = [
        "there is no effect `capstan-complience` in the catalogue",
        "where: the command line",
        "did you mean `capstan-compliance`?",
    ];
    refused(&sandbox, &["--without", "capstan-complience"], 2, &wanted);
    refused(
        &sandbox,
        &["--without", "backlash,capstan-complience"],
        2,
        &wanted,
    );
    // Where no name is near, all are said.
    refused(
        &sandbox,
        &["--without", "xyz"],
        2,
        &["`xyz`", "the names are: ", "cable-latency"],
    );
    refused(
        &sandbox,
        &["--without", ""],
        2,
        &["where: the command line"],
    );
}

#[test]
fn missing_files_are_named() {
    let sandbox = Sandbox::new();
    let further: [(&[&str], &str); 2] = [
        (&["--validate", "gone.csv"], "where: gone.csv"),
        (&["--model", "gone.toml"], "where: gone.toml"),
    ];
    for (arguments, wanted) in further {
        refused(&sandbox, arguments, 2, &[wanted]);
    }
    let device = sandbox.device_text();
    std::fs::remove_file(sandbox.path("device.toml")).unwrap();
    refused(&sandbox, &[], 2, &["where: device.toml", "cannot be read"]);
    sandbox.write("device.toml", device);
    std::fs::remove_file(sandbox.path("log.csv")).unwrap();
    refused(&sandbox, &[], 2, &["where: log.csv", "no such file"]);
}

#[test]
fn a_bad_cell_of_the_second_log_is_placed_there() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "cable_m");
    cells[4][index] = "abc".to_owned();
    let good = sandbox.log_text();
    sandbox.write_log(&cells);
    std::fs::rename(sandbox.path("log.csv"), sandbox.path("log2.csv")).unwrap();
    sandbox.write("log.csv", good);
    let place = format!("where: log2.csv:5:{}, column `cable_m`", index + 1);
    refused(&sandbox, &["--validate", "log2.csv"], 2, &[&place, "`abc`"]);
}

#[test]
fn a_model_of_another_device_is_refused() {
    let sandbox = Sandbox::new();
    let text = sandbox.device_text();
    // Without its last link and joint.
    let mut other: toml_edit::DocumentMut = text.parse().unwrap();
    for key in ["link", "joint"] {
        let rows = other[key].as_array_of_tables_mut().unwrap();
        rows.remove(rows.len() - 1);
    }
    other["device"]["dof"] = toml_edit::value(6);
    sandbox.write("other.toml", other.to_string());
    let wanted = ["where: other.toml", "6 joints", "has 7"];
    refused(&sandbox, &["--model", "other.toml"], 2, &wanted);
}

#[test]
fn two_rows_are_too_few() {
    let sandbox = Sandbox::new();
    sandbox.write_log(&sandbox.cells()[..3]);
    refused(
        &sandbox,
        &[],
        3,
        &["where: log.csv", "2 readings", "record at least"],
    );
}

#[test]
fn fewer_rows_than_parameters_are_too_few() {
    let sandbox = Sandbox::new();
    sandbox.write_log(&sandbox.cells()[..28]);
    refused(
        &sandbox,
        &[],
        3,
        &["where: log.csv", "27 readings", "record at least"],
    );
}

#[test]
fn one_pose_fixes_nothing() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let first = cells[1].clone();
    cells[1..].iter_mut().for_each(|row| row.clone_from(&first));
    sandbox.write_log(&cells);
    refused(
        &sandbox,
        &[],
        3,
        &[
            "where: log.csv",
            "no joint moves",
            "record at many different",
        ],
    );
}

#[test]
fn a_reading_too_large_to_square_is_refused() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "out3_rad");
    cells[10][index] = "1e300".to_owned();
    sandbox.write_log(&cells);
    let output = sandbox.diagnose(&[]);
    let message = text(&output.stderr);
    assert!(matches!(output.status.code(), Some(2 | 3)), "{message}");
    assert!(message.contains("where: log.csv"), "{message}");
    assert!(!sandbox.path("result").exists());
}

#[test]
fn a_folder_in_the_way_of_a_file_leaves_nothing_half_written() {
    let sandbox = Sandbox::new();
    std::fs::create_dir_all(sandbox.path("result/report.html")).unwrap();
    let output = sandbox.diagnose(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(names_in(&sandbox.path("result")), ["report.html"]);
}

#[test]
fn an_unwritable_place_is_refused_before_the_work() {
    let sandbox = Sandbox::new();
    sandbox.write("result", "a file");
    let output = sandbox.diagnose(&[]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot write"), "{message}");
    assert_eq!(
        std::fs::read_to_string(sandbox.path("result")).unwrap(),
        "a file"
    );
}

#[test]
fn an_unknown_flag_is_refused() {
    let sandbox = Sandbox::new();
    refused(
        &sandbox,
        &["--method", "joint"],
        2,
        &["unexpected argument '--method'"],
    );
}

#[test]
fn a_log_does_not_validate_itself() {
    let sandbox = Sandbox::new();
    let log = std::fs::read(sandbox.path("log.csv")).unwrap();
    sandbox.write("copy.csv", &log);
    // other bytes, the same readings
    sandbox.write("ends.csv", text(&log).replace('\n', "\r\n"));
    for name in ["log.csv", "copy.csv", "ends.csv"] {
        let place = format!("where: {name}");
        let wanted = ["the fit has seen every row", &place, "another recording"];
        refused(&sandbox, &["--validate", name], 2, &wanted);
    }
}

#[test]
fn a_second_log_without_readings_is_told_from_the_first() {
    let sandbox = Sandbox::new();
    let good = sandbox.log_text();
    let mut cells = sandbox.cells();
    let is_joint = |index: &usize| cells[0][*index].starts_with("theta");
    let joints: Vec<usize> = (0..cells[0].len()).filter(is_joint).collect();
    for row in &mut cells {
        *row = joints.iter().map(|&index| row[index].clone()).collect();
    }
    sandbox.write_log(&cells);
    std::fs::rename(sandbox.path("log.csv"), sandbox.path("log2.csv")).unwrap();
    sandbox.write("log.csv", good);
    let wanted = [
        "the log of --validate has no reading of a sensor; that of --log has out1, ",
        "where: log2.csv",
    ];
    refused(&sandbox, &["--validate", "log2.csv"], 2, &wanted);
}
