//! `haptical correct`: commands that take a corrected arm along the path of the nominal one.

use std::path::{Path, PathBuf};

use haptical_model::Device;
use serde_json::Value;

use crate::{haptical, names_in, text};

/// How far a command may leave the handle, by another road through the libraries \[m\], \[rad\].
const LANDED: f64 = 1e-9;

/// Two joints that yield, one in front of its external encoder and one behind it.
const YIELDS: &str = "\n[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n\
    [[effect]]\nname = \"joint-compliance\"\njoint = 3\nstiffness_nm_per_rad = 250.0\n";
/// A tracker whose place was found with the arm: poses of a path are the handle's all the same.
const TRACKER: &str = "[tracker]\nbase = \"unknown\"\ntool = \"unknown\"\nbase_xyz_m = [1.0, 2.0, 0.5]\n\
    base_wxyz = [0.6, 0.0, 0.8, 0.0]\ntool_xyz_m = [0.0, 0.0, 0.1]\ntool_wxyz = [1.0, 0.0, 0.0, 0.0]\n";

fn devices(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/devices")
        .join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {name} is not here, as in a packaged crate");
    None
}

/// A folder with nominal.toml and model.toml, the device of the paper and one that deviates and yields.
fn arms() -> Option<tempfile::TempDir> {
    let (nominal, deviating) = (devices("haptic7.toml")?, devices("haptic7-deviating.toml")?);
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(nominal, folder.path().join("nominal.toml")).unwrap();
    let model = std::fs::read_to_string(deviating).unwrap() + YIELDS + TRACKER;
    std::fs::write(folder.path().join("model.toml"), model).unwrap();
    Some(folder)
}

/// Joint readings without a pattern, within half of each range.
fn path(rows: usize) -> String {
    let mut table = String::from("t_s");
    for joint in 1..=7 {
        table.push_str(&format!(",theta{joint}_rad"));
    }
    for row in 0..rows {
        table.push_str(&format!("\n{}", row as f64 * 0.1));
        for joint in 0..7 {
            let share = (0.618_034 * (row * 7 + joint + 1) as f64).fract() - 0.5;
            table.push_str(&format!(",{}", 0.7 * share));
        }
    }
    table + "\n"
}

fn correct(folder: &Path, waypoints: &str, out: &str, further: &[&str]) -> std::process::Output {
    haptical()
        .current_dir(folder)
        .args([
            "correct",
            "--device",
            "nominal.toml",
            "--model",
            "model.toml",
        ])
        .args(["--waypoints", waypoints, "--out", out])
        .args(further)
        .output()
        .unwrap()
}

/// Columns of a table whose names begin so, row by row.
fn columns(table: &Path, begin: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows = lines.map(|line| {
        let cells = line.split(',').zip(&names);
        let own = cells.filter(|(_, name)| name.starts_with(begin));
        own.map(|(cell, _)| cell.parse().unwrap()).collect()
    });
    rows.collect()
}

/// The commands through the corrected model by `simulate --replay`, whose predictions are those of a calibration: geometry,
/// drives, a spring in front of an encoder and one behind it, under the arm's weight.
#[test]
fn the_commands_of_a_yielding_arm_land_on_the_path() {
    let Some(folder) = arms() else { return };
    let folder = folder.path();
    std::fs::write(folder.join("path.csv"), path(40)).unwrap();
    let output = correct(folder, "path.csv", "new/out.csv", &["--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["waypoints"], 40);
    let warnings = said["warnings"].as_array().unwrap().iter();
    let mut warnings = warnings.map(|own| own.as_str().unwrap());
    assert!(warnings.any(|own| own.contains("where the tracker stands was fitted with the arm")));
    // the path's own readings are millimetres off
    assert!(said["before_rms_m"].as_f64().unwrap() > 2e-3, "{said}");
    assert!(said["largest_rest_m"].as_f64().unwrap() < 1e-6);
    assert!(said["largest_rest_rad"].as_f64().unwrap() < 1e-6);
    assert_eq!(
        names_in(&folder.join("new")),
        ["out.csv", "out.csv.provenance.json"]
    );
    let replayed = haptical()
        .current_dir(folder)
        .args([
            "simulate",
            "--device",
            "model.toml",
            "--replay",
            "new/out.csv",
            "--out",
            "replayed.csv",
        ])
        .output()
        .unwrap();
    assert!(replayed.status.success(), "{}", text(&replayed.stderr));
    let residuals = std::fs::read_to_string(folder.join("replayed.csv.residuals.csv")).unwrap();
    let residuals = residuals.lines().skip(1).map(|line| {
        let residual = line.rsplit(',').next().unwrap();
        residual.parse::<f64>().unwrap().abs()
    });
    let residuals: Vec<f64> = residuals.collect();
    // three of a position and three of an orientation
    assert_eq!(residuals.len(), 40 * 6);
    let worst = residuals.iter().copied().fold(0.0, f64::max);
    assert!(worst < LANDED, "{worst:e}");
    // without the springs the same commands are elsewhere: they were counted
    let rigid = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    std::fs::write(folder.join("rigid.toml"), rigid.replace(YIELDS, "")).unwrap();
    let replayed = haptical()
        .current_dir(folder)
        .args([
            "simulate",
            "--device",
            "rigid.toml",
            "--replay",
            "new/out.csv",
            "--out",
            "rigid.csv",
            "--json",
        ])
        .output()
        .unwrap();
    let said: Value = serde_json::from_slice(&replayed.stdout).unwrap();
    assert!(
        said["channels"][0]["rms"].as_f64().unwrap() > 1e-4,
        "{said}"
    );
    // the same bytes again, over its own file
    let before = std::fs::read(folder.join("new/out.csv")).unwrap();
    assert!(
        correct(folder, "path.csv", "new/out.csv", &[])
            .status
            .success()
    );
    assert_eq!(std::fs::read(folder.join("new/out.csv")).unwrap(), before);
}

/// Poses that are given as poses, from nowhere and from a start; readings stay within the limits.
#[test]
fn poses_are_reached_from_nowhere_and_nearer_from_a_start() {
    let Some(folder) = arms() else { return };
    let folder = folder.path();
    std::fs::write(folder.join("path.csv"), path(10)).unwrap();
    assert!(correct(folder, "path.csv", "out.csv", &[]).status.success());
    let table = std::fs::read_to_string(folder.join("out.csv")).unwrap();
    let poses: Vec<String> = table
        .lines()
        .map(|line| {
            line.split(',')
                .skip(8)
                .take(7)
                .collect::<Vec<_>>()
                .join(",")
        })
        .collect();
    assert_eq!(poses[0], "x_m,y_m,z_m,qw,qx,qy,qz");
    std::fs::write(folder.join("poses.csv"), poses.join("\n")).unwrap();
    let output = correct(folder, "poses.csv", "from-poses.csv", &["--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(said["before_rms_m"].is_null() && said["largest_rest_m"].as_f64().unwrap() < 1e-6);
    let model = Device::load(&folder.join("model.toml")).unwrap().device;
    for row in columns(&folder.join("from-poses.csv"), "theta") {
        for (joint, reading) in model.joints.iter().zip(row) {
            assert!(
                (joint.lower_rad..=joint.upper_rad).contains(&reading),
                "{reading}"
            );
        }
    }
    // with a start beside the poses the commands are those of the path
    let starts = path(10);
    let starts = starts.lines().map(|line| line.split_once(',').unwrap().1);
    let both: Vec<String> = starts
        .zip(&poses)
        .map(|(a, b)| format!("{a},{b}"))
        .collect();
    std::fs::write(folder.join("both.csv"), both.join("\n")).unwrap();
    assert!(
        correct(folder, "both.csv", "from-both.csv", &[])
            .status
            .success()
    );
    let commands = ["out.csv", "from-both.csv"].map(|name| columns(&folder.join(name), "theta"));
    let pairs = commands[0]
        .iter()
        .flatten()
        .zip(commands[1].iter().flatten());
    let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-7, "{apart:e}");
    // the position alone, of the same poses
    let output = correct(
        folder,
        "both.csv",
        "positions.csv",
        &["--match", "position", "--json"],
    );
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(said["largest_rest_rad"].is_null() && said["largest_rest_m"].as_f64().unwrap() < 1e-6);
    let moved = |name: &str| -> f64 {
        let (own, start) = (
            columns(&folder.join(name), "theta"),
            columns(&folder.join("both.csv"), "theta"),
        );
        let pairs = own.iter().flatten().zip(start.iter().flatten());
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    assert!(moved("positions.csv") < moved("out.csv"));
}

#[test]
fn waypoints_out_of_reach_are_named_and_nothing_is_written() {
    let Some(folder) = arms() else { return };
    let folder = folder.path();
    let far = "x_m,y_m,z_m\n0.134,0.041,0.077\n5,5,5\n0.149,0.040,0.075\n0,3,0\n";
    std::fs::write(folder.join("far.csv"), far).unwrap();
    let before = names_in(folder);
    let output = correct(folder, "far.csv", "out.csv", &[]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said.contains("2 of 4 waypoints") && said.contains("row 2 (line 3)"),
        "{said}"
    );
    assert!(
        said.contains("row 4 (line 5)") && said.contains("far.csv:3"),
        "{said}"
    );
    assert_eq!(names_in(folder), before);
    // a rest that is allowed is written, and said
    let output = correct(
        folder,
        "far.csv",
        "out.csv",
        &["--within-m", "10", "--json"],
    );
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rests = columns(&folder.join("out.csv"), "rest_m");
    assert!(rests[1][0] > 5.0 && rests[0][0] < 1e-6, "{rests:?}");
    assert_eq!(said["largest_rest_m"], rests[1][0]);
}

#[test]
fn what_depends_on_the_motion_is_left_out_and_named() {
    let Some(folder) = arms() else { return };
    let folder = folder.path();
    std::fs::write(folder.join("path.csv"), path(3)).unwrap();
    let model = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let play = "[[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 1e-3\n";
    std::fs::write(folder.join("model.toml"), model + play).unwrap();
    let output = correct(folder, "path.csv", "out.csv", &[]);
    assert!(output.status.success());
    let said = text(&output.stderr);
    assert!(
        said.contains("effect left out: backlash@1: it depends on how the arm moves"),
        "{said}"
    );
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let Some(folder) = arms() else { return };
    let folder = folder.path();
    for (table, words) in [
        ("qw,qx,qy,qz,theta1_rad\n", "theta2_rad"),
        ("x_m,y_m,z_m\n0.1,,0.2\n0.1,0.2,0.3\n", "not complete"),
        ("x_m,y_m,z_m\n0.1,0.1,0.2\n0.1,zwei,0.3\n", ":3:2"),
        ("theta1_rad\n0.1\n0.2\n", "theta2_rad"),
    ] {
        std::fs::write(folder.join("wrong.csv"), table).unwrap();
        let output = correct(folder, "wrong.csv", "out.csv", &[]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{table}\n{said}");
        assert!(
            said.contains(words) && said.contains("wrong.csv"),
            "{table}\n{said}"
        );
    }
    std::fs::write(
        folder.join("positions.csv"),
        "x_m,y_m,z_m\n0.1,0.1,0.2\n0.1,0.1,0.3\n",
    )
    .unwrap();
    let output = correct(folder, "positions.csv", "out.csv", &["--match", "pose"]);
    assert!(text(&output.stderr).contains("no orientations to match"));
    std::fs::write(folder.join("model.toml"), "[[joint]]\n").unwrap();
    let output = correct(folder, "positions.csv", "out.csv", &[]);
    assert!(text(&output.stderr).contains("the model has 1 joints, the device has 7"));
    assert!(!folder.join("out.csv").exists());
}
