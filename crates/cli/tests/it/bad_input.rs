//! Every bad input is answered with its place and leaves no file behind.

use std::io::Write;

use crate::{Sandbox, column, haptical, names_in, text};

/// Runs identify, plain and with --json: exit status, the three lines, their JSON form, no files.
/// `wanted` are texts that the message must hold.
fn refused(sandbox: &Sandbox, status: i32, wanted: &[&str]) {
    let plain = sandbox.identify(&[]);
    let message = text(&plain.stderr);
    assert_eq!(plain.status.code(), Some(status), "{message}");
    assert!(plain.stdout.is_empty());
    let lines: Vec<&str> = message.lines().collect();
    let start = lines.iter().position(|line| line.starts_with("error: "));
    let [error, place, next] = lines[start.unwrap()..] else {
        panic!("not three lines: {message}");
    };
    assert!(error.len() > "error: ".len(), "{message}");
    assert!(place.starts_with("  where: "), "{message}");
    assert!(next.starts_with("  next: "), "{message}");
    for wanted in wanted {
        assert!(message.contains(wanted), "`{wanted}` is not in: {message}");
    }
    assert_eq!(names_in(&sandbox.path("result")), Vec::<String>::new());

    let json = sandbox.identify(&["--json"]);
    assert_eq!(json.status.code(), Some(status));
    let object: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let said = &object["error"];
    assert_eq!(format!("error: {}", said["what"].as_str().unwrap()), error);
    assert_eq!(
        format!("  where: {}", said["where"].as_str().unwrap()),
        place
    );
    assert_eq!(format!("  next: {}", said["next"].as_str().unwrap()), next);
    assert!(!said["kind"].as_str().unwrap().is_empty());
    assert_eq!(text(&json.stderr), message);
    assert_eq!(names_in(&sandbox.path("result")), Vec::<String>::new());
}

#[test]
fn a_missing_column_is_named() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let gone = column(&cells, "theta3_rad");
    cells.iter_mut().for_each(|row| drop(row.remove(gone)));
    sandbox.write_log(&cells);
    refused(&sandbox, 2, &["where: log.csv:1", "missing `theta3_rad`"]);
}

#[test]
fn not_a_number_in_a_cell_is_placed() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "theta2_rad");
    cells[9][index] = "NaN".to_owned();
    sandbox.write_log(&cells);
    let place = format!("where: log.csv:10:{}, column `theta2_rad`", index + 1);
    refused(&sandbox, 2, &[&place, "`NaN`", "finite"]);
}

#[test]
fn text_in_a_number_is_placed() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "cable_m");
    cells[4][index] = "abc".to_owned();
    sandbox.write_log(&cells);
    let place = format!("where: log.csv:5:{}, column `cable_m`", index + 1);
    refused(&sandbox, 2, &[&place, "`abc`"]);
}

#[test]
fn a_reading_beyond_any_device_is_placed_on_held_out_rows_too() {
    // Row 50 is in the first block that is held out, row 10 is not.
    for row in [50, 10] {
        let sandbox = Sandbox::new();
        let mut cells = sandbox.cells();
        let index = column(&cells, "out3_rad");
        cells[row][index] = "1e300".to_owned();
        sandbox.write_log(&cells);
        let place = format!(
            "where: log.csv:{}:{}, column `out3_rad`",
            row + 1,
            index + 1
        );
        refused(&sandbox, 2, &[&place, "`1e300`", "leave the cell empty"]);
    }
}

#[test]
fn time_that_runs_backwards_is_placed() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    for (row, line) in cells.iter_mut().enumerate() {
        let time = match row {
            0 => "t_s".to_owned(),
            7 => "0.01".to_owned(),
            _ => format!("{}", row as f64 / 10.0),
        };
        line.insert(0, time);
    }
    sandbox.write_log(&cells);
    refused(
        &sandbox,
        2,
        &["where: log.csv:8:1, column `t_s`", "0.01", "0.6"],
    );
}

#[test]
fn two_rows_are_too_few() {
    let sandbox = Sandbox::new();
    sandbox.write_log(&sandbox.cells()[..3]);
    refused(&sandbox, 3, &["log.csv", "2 readings cannot fix"]);
}

#[test]
fn fewer_rows_than_parameters_are_too_few() {
    let sandbox = Sandbox::new();
    sandbox.write_log(&sandbox.cells()[..28]);
    refused(
        &sandbox,
        3,
        &[
            "log.csv",
            "27 readings cannot fix 28 parameters",
            "record at least",
        ],
    );
}

#[test]
fn one_pose_fixes_nothing() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let first = cells[1].clone();
    cells[1..].iter_mut().for_each(|row| row.clone_from(&first));
    sandbox.write_log(&cells);
    refused(&sandbox, 3, &["log.csv", "no joint moves", "400 rows"]);
}

#[test]
fn a_handle_on_top_of_the_cable_exit_is_placed() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "cable_m");
    cells[20][index] = "0".to_owned();
    sandbox.write_log(&cells);
    refused(
        &sandbox,
        2,
        &[
            "where: log.csv:21, column `cable_m`",
            "on top of the cable exit",
        ],
    );
}

#[test]
fn a_ratio_of_zero_is_placed() {
    let sandbox = Sandbox::new();
    let text = sandbox.device_text();
    let changed = text.replacen("transmission_ratio = 8.0", "transmission_ratio = 0", 1);
    let line = 1 + changed
        .lines()
        .position(|line| line == "transmission_ratio = 0")
        .unwrap();
    sandbox.write("device.toml", changed);
    let place = format!("where: device.toml:{line}:22");
    refused(
        &sandbox,
        2,
        &[&place, "transmission_ratio", "cannot be zero"],
    );
}

#[test]
fn degrees_in_the_log_are_called_degrees() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    let index = column(&cells, "theta2_rad");
    for row in &mut cells[1..] {
        let radians: f64 = row[index].parse().unwrap();
        row[index] = (radians / std::f64::consts::PI * 180.0).to_string();
    }
    sandbox.write_log(&cells);
    refused(
        &sandbox,
        2,
        &["looks like degrees", "column `theta2_rad`", "log.csv:"],
    );
}

#[test]
fn degrees_in_the_device_are_called_degrees() {
    let sandbox = Sandbox::new();
    let text = sandbox.device_text();
    sandbox.write(
        "device.toml",
        text.replacen("alpha_rad = -1.570796326794897", "alpha_rad = -90", 1),
    );
    refused(
        &sandbox,
        2,
        &["where: device.toml:10:13", "looks like degrees"],
    );
}

#[test]
fn a_truncated_gzip_log_is_refused() {
    let sandbox = Sandbox::new();
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(sandbox.log_text().as_bytes()).unwrap();
    let bytes = encoder.finish().unwrap();
    sandbox.write("log.csv", &bytes[..bytes.len() / 2]);
    refused(&sandbox, 2, &["where: log.csv", "gzip", "cut off"]);
}

#[test]
fn a_missing_log_is_refused() {
    let sandbox = Sandbox::new();
    std::fs::remove_file(sandbox.path("log.csv")).unwrap();
    refused(&sandbox, 2, &["where: log.csv", "no such file"]);
}

#[test]
fn a_missing_device_is_refused() {
    let sandbox = Sandbox::new();
    std::fs::remove_file(sandbox.path("device.toml")).unwrap();
    refused(&sandbox, 2, &["where: device.toml", "cannot be read"]);
}

#[test]
fn a_device_without_joints_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("device.toml", "[device]\nname = \"nothing\"\n");
    refused(&sandbox, 2, &["where: device.toml", "[[joint]]"]);
}

#[test]
fn a_device_that_is_not_toml_is_placed() {
    let sandbox = Sandbox::new();
    sandbox.write("device.toml", "[device]\nname = nothing at all\n");
    refused(&sandbox, 2, &["where: device.toml:2:"]);
}

#[test]
fn a_log_of_fewer_joints_than_the_device_is_refused() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    for joint in [7, 6] {
        let gone = column(&cells, &format!("theta{joint}_rad"));
        cells.iter_mut().for_each(|row| drop(row.remove(gone)));
    }
    sandbox.write_log(&cells);
    refused(&sandbox, 2, &["log.csv:1", "`theta6_rad`", "`theta7_rad`"]);
}

#[test]
fn a_log_of_more_joints_than_the_device_is_refused_or_warned_of() {
    let sandbox = Sandbox::new();
    let mut cells = sandbox.cells();
    for (row, line) in cells.iter_mut().enumerate() {
        line.push(if row == 0 {
            "theta8_rad".into()
        } else {
            "0.1".into()
        });
    }
    sandbox.write_log(&cells);
    let output = sandbox.identify(&[]);
    let message = text(&output.stderr);
    assert!(message.contains("theta8_rad"), "{message}");
}

#[test]
fn an_unknown_flag_is_refused() {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&["--frobnicate"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        message.contains("error: unexpected argument '--frobnicate' found"),
        "{message}"
    );
    assert!(
        message.contains("  where: the command line\n  next: "),
        "{message}"
    );
    let json = sandbox.identify(&["--frobnicate", "--json"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(object["error"]["kind"], "arguments");
    assert!(!sandbox.path("result").exists());
}

#[test]
fn a_share_above_one_half_is_refused() {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&["--held-out", "0.9"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("a share from 0 to 0.5 is expected"));
}

#[test]
fn a_file_in_the_way_of_the_folder_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("blocked", "a file");
    for out in ["blocked", "blocked/result"] {
        let output = sandbox_identify_to(&sandbox, out);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("cannot write"), "{message}");
        assert!(message.contains("blocked"), "{message}");
    }
    assert_eq!(
        std::fs::read_to_string(sandbox.path("blocked")).unwrap(),
        "a file"
    );
}

#[test]
fn a_folder_in_the_way_of_a_file_leaves_nothing_half_written() {
    let sandbox = Sandbox::new();
    std::fs::create_dir_all(sandbox.path("result/report.html")).unwrap();
    let output = sandbox.identify(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(names_in(&sandbox.path("result")), ["report.html"]);
}

fn sandbox_identify_to(sandbox: &Sandbox, out: &str) -> std::process::Output {
    haptical()
        .current_dir(sandbox.folder.path())
        .args([
            "identify",
            "--device",
            "device.toml",
            "--log",
            "log.csv",
            "--out",
            out,
        ])
        .output()
        .unwrap()
}
