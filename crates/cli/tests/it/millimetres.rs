//! Millimetres taken for metres where no column by itself says so: an unknown tracker, a rail, two sockets.

use std::path::Path;
use std::process::Output;

use crate::{haptical, text};

const ARM: &str = "[[link]]\na_m = 0.0\nalpha_rad = 1.5707963\nd_m = 0.3\n\
    [[link]]\na_m = 0.4\nalpha_rad = 0.3\nd_m = 0.1\n\
    [[link]]\na_m = 0.3\nalpha_rad = 1.2\nd_m = 0.05\n";
const JOINT: &str = "[[joint]]\ntransmission = \"direct\"\n";
const UNKNOWN: &str = "[tracker]\nbase = \"unknown\"\ntool = \"unknown\"\nposition_sd_m = 1e-4\n";

fn check(folder: &Path, device: &str, log: &str) -> Output {
    std::fs::write(folder.join("device.toml"), device).unwrap();
    std::fs::write(folder.join("log.csv"), log).unwrap();
    ran(folder, &["check", "device.toml", "log.csv"])
}

/// `haptical check` and `haptical identify`.
fn both(folder: &Path, device: &str, log: &str) -> [Output; 2] {
    let identify = [
        "identify",
        "--device",
        "device.toml",
        "--log",
        "log.csv",
        "--out",
        "result",
    ];
    [check(folder, device, log), ran(folder, &identify)]
}

fn ran(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = haptical();
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn refused(device: &str, log: &str, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    for output in both(folder.path(), device, log) {
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        for word in words {
            assert!(said.contains(word), "no `{word}` in {said}");
        }
        assert!(said.contains("by 1000"), "{said}");
    }
}

/// Places of a point that moves as the arm does, roughly, at `scale` per metre and far from the origin.
fn tracked(header: &str, scale: f64) -> String {
    let mut log = format!("{header},x_m,y_m,z_m\n");
    for row in 0..60 {
        let turn = 0.1 * f64::from(row);
        let place =
            [turn.cos(), turn.sin(), (1.7 * turn).sin()].map(|part| scale * (3.0 + 0.4 * part));
        let [x, y, z] = place;
        log += &format!(
            "{:.6},{:.6},{x:.6},{y:.6},{z:.6}\n",
            turn.sin(),
            (2.1 * turn).cos()
        );
    }
    log
}

#[test]
fn positions_of_a_tracker_at_an_unknown_place() {
    let device = format!("{ARM}{JOINT}{JOINT}{UNKNOWN}");
    let header = "theta1_rad,theta2_rad";
    refused(
        &device,
        &tracked(header, 1e3),
        &["`x_m, y_m, z_m`", "looks like millimetres"],
    );
    // far away, in metres
    let folder = tempfile::tempdir().unwrap();
    let check = check(folder.path(), &device, &tracked(header, 1.0));
    assert!(
        !text(&check.stderr).contains("millimetres"),
        "{}",
        text(&check.stderr)
    );
}

#[test]
fn readings_of_a_rail() {
    for limits in ["lower_m = -1.4\nupper_m = 1.4\n", ""] {
        let rail = format!("[[joint]]\ntype = \"prismatic\"\ntransmission = \"direct\"\n{limits}");
        let device = format!("{ARM}{rail}{JOINT}{UNKNOWN}");
        let metres = tracked("theta1_m,theta2_rad", 1.0);
        let lines: Vec<String> = metres
            .lines()
            .enumerate()
            .map(|(row, line)| match line.split_once(',') {
                Some((_, rest)) if row > 0 => format!("{},{rest}", 400 + 10 * row),
                _ => line.to_owned(),
            })
            .collect();
        refused(
            &device,
            &(lines.join("\n") + "\n"),
            &["`theta1_m`", "looks like millimetres"],
        );
        let folder = tempfile::tempdir().unwrap();
        let check = check(folder.path(), &device, &metres);
        assert!(
            !text(&check.stderr).contains("millimetres"),
            "{}",
            text(&check.stderr)
        );
    }
}

#[test]
fn a_distance_between_sockets() {
    let mut log = "theta1_rad,theta2_rad,contact\n".to_owned();
    for row in 0..60 {
        let turn = 0.1 * f64::from(row);
        let id = ["left", "right"][row as usize % 2];
        log += &format!("{:.6},{:.6},{id}\n", turn.sin(), (2.1 * turn).cos());
    }
    let pair = "[[contact_pair]]\na = \"left\"\nb = \"right\"\nsd_m = 1e-4\n";
    let device = format!("{ARM}{JOINT}{JOINT}{pair}distance_m = 200.0\n");
    refused(
        &device,
        &log,
        &["distance_m = 200", "`left` and `right`", "[[contact_pair]]"],
    );
    let folder = tempfile::tempdir().unwrap();
    let device = format!("{ARM}{JOINT}{JOINT}{pair}distance_m = 0.2\n");
    let check = check(folder.path(), &device, &log);
    assert!(
        !text(&check.stderr).contains("millimetres"),
        "{}",
        text(&check.stderr)
    );
}
