//! Logs of joints and their commands alone: diagnosed, refused in words; LeRobot data sets.

use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::{haptical, text};

fn device() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/devices/so101.toml")
}

#[cfg(feature = "parquet")]
fn dataset() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/lerobot")
}

fn diagnosed(log: &Path, out: &Path, further: &[&str]) -> Output {
    haptical()
        .args(["diagnose", "--json", "--device"])
        .arg(device())
        .arg("--log")
        .arg(log)
        .arg("--out")
        .arg(out)
        .args(further)
        .output()
        .unwrap()
}

fn gap(log: &Path, out: &Path, further: &[&str]) -> Value {
    let output = diagnosed(log, out, further);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[cfg(feature = "parquet")]
fn import(from: &Path, log: &Path, further: &[&str]) -> Output {
    haptical()
        .args(["import", "lerobot"])
        .arg(from)
        .arg("--out")
        .arg(log)
        .args(further)
        .output()
        .unwrap()
}

/// A log of six joints at 50 Hz that follow 60 ms late; the third loses 17 degrees at 30 s.
fn log_text(command_per_rad: f64) -> String {
    let mut text = "t_s".to_owned();
    for stem in ["theta", "command"] {
        (1..=6).for_each(|joint| text.push_str(&format!(",{stem}{joint}_rad")));
    }
    text.push('\n');
    let command = |joint: usize, time_s: f64| {
        let j = joint as f64;
        0.3 * ((0.7 + 0.2 * j) * time_s + j).sin() + 0.1 * ((2.9 + 0.3 * j) * time_s).sin()
    };
    for row in 0..3000 {
        let time_s = 0.02 * f64::from(row);
        text.push_str(&format!("{time_s:.2}"));
        for joint in 0..6 {
            let lost = if joint == 2 && row >= 1500 {
                -0.2967
            } else {
                0.0
            };
            let read = command(joint, (time_s - 0.06).max(0.0)) + lost;
            let count = std::f64::consts::TAU / 4096.0;
            text.push_str(&format!(",{:.6}", (read / count).round() * count));
        }
        for joint in 0..6 {
            text.push_str(&format!(",{:.6}", command(joint, time_s) * command_per_rad));
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_check_says_what_commands_are_good_for() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let checked = |text_of_log: &str, further: &[&str]| {
        std::fs::write(&log, text_of_log).unwrap();
        let mut command = haptical();
        command.arg("check").arg(device()).arg(&log).args(further);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let whole = log_text(1.0);
    let said = checked(&whole, &[]);
    let tested = "tests how joints 1, 2, 3, 4, 5, 6 follow the command: command-latency";
    assert!(said.contains(tested) && said.contains("geometry"), "{said}");
    let json: Value = serde_json::from_str(&checked(&whole, &["--json"])).unwrap();
    assert_eq!(json["log"]["channels"][2]["channel"], "command3");
    assert_eq!(json["log"]["channels"][2]["readings"], 3000);
    // a joint without a command, and a log without times
    let without = whole.replacen("command6_rad", "wanted_rad", 1);
    let said = checked(&without, &[]);
    let not = "cannot test how joint 6 follows the command: the log has no command of it";
    assert!(said.contains(not), "{said}");
    let said = checked(&whole.replacen("t_s", "clock", 1), &[]);
    let not = "cannot test how joints 1, 2, 3, 4, 5, 6 follow the command: no column t_s";
    assert!(said.contains(not), "{said}");
}

#[test]
fn a_lost_offset_is_named_placed_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("log.csv"), folder.path().join("result"));
    std::fs::write(&log, log_text(1.0)).unwrap();
    let answer = gap(&log, &out, &[]);
    assert_eq!(answer["verdict"], "named", "{answer}");
    let first = &answer["causes"][0];
    assert_eq!(
        (&first["effect"], &first["joint"]),
        (&"joint-offset".into(), &3.into())
    );
    let number = |name: &str| first["parameters"][name]["value"].as_f64().unwrap();
    assert!((number("offset_rad") + 0.2967).abs() < 2e-3, "{first}");
    assert!((number("time_s") - 30.0).abs() < 0.03, "{first}");
    let region = answer["where"]["region"].as_str().unwrap();
    assert!(
        region.contains("joint 3") && region.contains("-17.0 degrees"),
        "{region}"
    );
    assert_eq!(answer["gap"]["channels"].as_array().unwrap().len(), 6);
    // the others are late, and no more
    let others = answer["causes"].as_array().unwrap()[1..].iter();
    assert!(others.clone().count() >= 6);
    for cause in others {
        assert_eq!(cause["effect"], "command-latency", "{cause}");
    }
    let page = std::fs::read_to_string(out.join("gap.html")).unwrap();
    assert!(page.contains("joint-offset") && page.contains("<svg") && page.contains("theta3"));
    let without = gap(
        &log,
        &folder.path().join("without"),
        &["--without", "joint-offset"],
    );
    let named = without["causes"].as_array().unwrap().iter();
    assert!(
        named.clone().all(|cause| cause["effect"] != "joint-offset"),
        "{without}"
    );
}

/// Six joints at 50 Hz for 60 s that stand `beside` their commands by a number of radians.
fn beside(shift_s: f64, beside: &dyn Fn(usize, usize) -> f64) -> String {
    let mut text = "t_s".to_owned();
    for stem in ["theta", "command"] {
        (1..=6).for_each(|joint| text.push_str(&format!(",{stem}{joint}_rad")));
    }
    (1..=6).for_each(|joint| text.push_str(&format!(",torque{joint}_nm")));
    let command = |joint: usize, time_s: f64| {
        let at = time_s + shift_s;
        let speed = 0.7 + 0.2 * joint as f64;
        0.3 * (speed * at).sin() + 0.1 * ((2.9 + speed) * at).cos()
    };
    for row in 0..3000 {
        let time_s = 0.02 * row as f64;
        text.push_str(&format!("\n{time_s:.2}"));
        for joint in 0..6 {
            let count = std::f64::consts::TAU / 4096.0;
            let read = command(joint, (time_s - 0.06).max(0.0)) + beside(joint, row);
            text.push_str(&format!(",{:.6}", (read / count).round() * count));
        }
        (0..6).for_each(|joint| text.push_str(&format!(",{:.6}", command(joint, time_s))));
        for joint in 0..6 {
            // counts of 0.02 N m; the fourth drive's are four times as large from 40 s on
            let counts = (7.0 * command(joint, time_s).abs()).round()
                + f64::from(row as u32 * row as u32 % 3);
            let scale = if joint == 3 && row >= 2000 { 4.0 } else { 1.0 };
            text.push_str(&format!(",{:.6}", 0.02 * scale * counts));
        }
    }
    text.push('\n');
    text
}

/// The second recording is predicted with what the first one shows: of a joint that has changed since, the error grows.
#[test]
fn a_second_recording_is_predicted_and_not_fitted() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let offset = |joint: usize, _: usize| if joint == 1 { 0.08 } else { 0.0 };
    std::fs::write(path("log.csv"), beside(0.0, &offset)).unwrap();
    std::fs::write(path("log2.csv"), beside(100.0, &offset)).unwrap();
    // the second joint stands on the other side
    let turned = |joint: usize, row: usize| -offset(joint, row);
    std::fs::write(path("other.csv"), beside(100.0, &turned)).unwrap();
    let asked = |second: &str, out: &str| {
        let second = path(second);
        let flags = ["--validate", second.to_str().unwrap()];
        gap(&path("log.csv"), &path(out), &flags)
    };
    let channel = |answer: &Value, name: &str| {
        let mut channels = answer["gap"]["channels"].as_array().unwrap().iter();
        channels.find(|own| own["channel"] == name).unwrap().clone()
    };
    let number = |channel: &Value, name: &str| channel[name].as_f64().unwrap();
    let seen = asked("log2.csv", "out");
    for joint in 1..=6 {
        let own = channel(&seen, &format!("theta{joint}"));
        assert!(number(&own, "reduction_percent") > 95.0, "{own}");
        assert!(number(&own, "rms_after") < 1.2e-3, "{own}");
    }
    let table = std::fs::read_to_string(path("out").join("predictions.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 6 * 3000);
    let row = table
        .lines()
        .find(|line| line.starts_with("2000,theta2,"))
        .unwrap();
    let cells: Vec<f64> = row
        .split(',')
        .skip(2)
        .map(|cell| cell.parse().unwrap())
        .collect();
    assert!(
        (cells[0] - cells[2]).abs() < 2e-3 && (cells[0] - cells[1]).abs() > 0.03,
        "{row}"
    );
    let other = asked("other.csv", "other");
    let own = channel(&other, "theta2");
    assert!((number(&own, "rms_after") - 0.16).abs() < 2e-3, "{own}");
    assert!(number(&own, "reduction_percent") < 0.0, "{own}");
    assert!(number(&channel(&other, "theta3"), "reduction_percent") > 95.0);
}

/// Joints that stand where they are told; in the second recording one stands beside.
#[test]
fn a_second_recording_beside_joints_without_a_gap_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, shift_s: f64, offset_rad: f64| {
        let mut text = "t_s".to_owned();
        for stem in ["theta", "command"] {
            (1..=6).for_each(|joint| text.push_str(&format!(",{stem}{joint}_rad")));
        }
        let count = std::f64::consts::TAU / 4096.0;
        for row in 0..3000 {
            let time_s = 0.02 * f64::from(row);
            text.push_str(&format!("\n{time_s:.2}"));
            let commands: Vec<f64> = (1..=6)
                .map(|joint| 0.4 * ((0.5 + 0.2 * f64::from(joint)) * (time_s + shift_s)).sin())
                .collect();
            for (joint, command) in commands.iter().enumerate() {
                let read = command + if joint == 1 { offset_rad } else { 0.0 };
                text.push_str(&format!(",{:.6}", (read / count).round() * count));
            }
            for command in commands {
                text.push_str(&format!(",{command:.6}"));
            }
        }
        text.push('\n');
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let first = write("log.csv", 0.0, 0.0);
    for (offset_rad, wanted) in [(0.0, "no-gap"), (0.02, "unknown")] {
        let second = write("second.csv", 70.0, offset_rad);
        let flags = ["--validate", second.to_str().unwrap()];
        let answer = gap(&first, &folder.path().join("out"), &flags);
        assert_eq!(answer["verdict"], wanted, "{answer}");
        let channels = answer["second_recording"]["channels"].as_array().unwrap();
        let has_gap = |own: &&Value| own["has_gap"] == true;
        let with_gap: Vec<&Value> = channels.iter().filter(has_gap).collect();
        assert_eq!(with_gap.len(), usize::from(offset_rad > 0.0), "{answer}");
        assert!(with_gap.iter().all(|own| own["channel"] == "theta2"));
    }
}

/// A scale of torques that changes is a cause by itself, also of joints that stand still.
#[test]
fn a_torque_of_another_scale_is_named_and_placed() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    std::fs::write(&log, beside(0.0, &|_, _| 0.0)).unwrap();
    let answer = gap(&log, &folder.path().join("out"), &[]);
    let of_torque = |answer: &Value| {
        let causes = answer["causes"].as_array().unwrap().clone();
        let own: Vec<Value> = causes
            .into_iter()
            .filter(|own| own["effect"] == "torque-gain")
            .collect();
        own
    };
    let found = of_torque(&answer);
    assert_eq!(found.len(), 1, "{answer}");
    assert_eq!(found[0]["joint"], 4);
    assert_eq!(found[0]["parameters"]["factor"]["value"], 4.0);
    let at_s = found[0]["parameters"]["time_s"]["value"].as_f64().unwrap();
    assert!((at_s - 40.0).abs() < 0.2, "{found:?}");
    let region = answer["where"]["region"].as_str().unwrap();
    assert!(
        region.contains("scale of its torque") && region.contains("4.00"),
        "{region}"
    );
    assert_eq!(answer["where"]["channel"], "torque4");
    let without = gap(
        &log,
        &folder.path().join("without"),
        &["--without", "torque-gain"],
    );
    assert_eq!(of_torque(&without).len(), 0);
}

#[test]
fn commands_in_degrees_and_a_standstill_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    for (content, words) in [
        (log_text(180.0 / std::f64::consts::PI), ["57.", "degrees"]),
        (log_text(0.0), ["joint 1", "does not move"]),
    ] {
        std::fs::write(&log, content).unwrap();
        let output = diagnosed(&log, &folder.path().join("result"), &[]);
        let said = text(&output.stderr) + &text(&output.stdout);
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }
}

#[cfg(feature = "parquet")]
#[test]
fn a_data_set_of_lerobot_says_between_which_episodes_a_joint_lost_its_offset() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let output = import(&dataset(), &log, &["--units", "degrees", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&said["rows"], &said["joints"]), (&3420.into(), &6.into()));
    assert!(
        said["warnings"][0]
            .as_str()
            .unwrap()
            .contains("theta3 is elbow_flex"),
        "{said}"
    );
    let answer = gap(&log, &folder.path().join("result"), &[]);
    let first = &answer["causes"][0];
    assert_eq!(
        (&first["effect"], &first["joint"]),
        (&"joint-offset".into(), &3.into())
    );
    assert_eq!(first["parameters"]["from_run"]["value"], 42.0, "{first}");
    let lost = first["parameters"]["offset_rad"]["value"].as_f64().unwrap();
    assert!((lost + 17_f64.to_radians()).abs() < 5e-3, "{first}");
    // the other joints are late, and nothing came about in them
    let mut others = answer["causes"].as_array().unwrap()[1..].iter();
    assert!(
        others.all(|cause| cause["parameters"]["from_run"].is_null()),
        "{answer}"
    );
    let region = answer["where"]["region"].as_str().unwrap();
    assert!(region.contains("between runs 41 and 42"), "{region}");
}

#[cfg(feature = "parquet")]
#[test]
fn units_are_said_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let refused = |flags: &[&str], words: &[&str]| {
        let output = import(&dataset(), &log, flags);
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
        assert!(!log.exists());
    };
    refused(&[], &["does not say its units", "--units"]);
    refused(&["--units", "percent"], &["--device"]);
    let file = dataset().join("data/chunk-000/file-000.parquet");
    let output = diagnosed(&file, &folder.path().join("result"), &[]);
    assert!(
        text(&output.stderr).contains("haptical import lerobot"),
        "{}",
        text(&output.stderr)
    );
    let device = device();
    let flags = ["--units", "percent", "--device", device.to_str().unwrap()];
    let output = import(&file, &log, &flags);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    // 10 % of a gripper whose 100 % are 1.92 rad, from -0.17 rad on: of the first row's command, 8 sin 0 + 20 sin 5 to two digits
    let first = std::fs::read_to_string(&log).unwrap();
    let first: Vec<f64> = first
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .map(|cell| cell.parse().unwrap_or(f64::NAN))
        .collect();
    let expected = -0.17 - 0.0192 * 19.18;
    assert!((first[13] - expected).abs() < 1e-5, "{first:?}");
}

#[cfg(feature = "parquet")]
#[test]
fn data_sets_of_other_keys_and_orders_are_read_by_their_words_and_the_device() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let imported = |from: &Path, flags: &[&str]| {
        let flags = [flags, &["--force", "--json"]].concat();
        let output = import(from, &log, &flags);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        (
            said["warnings"].to_string(),
            std::fs::read_to_string(&log).unwrap(),
        )
    };
    let other = dataset().join("other.parquet");
    let (said, rows) = imported(&other, &["--units", "radians"]);
    assert!(said.contains("no commands of these joints"), "{said}");
    assert!(said.contains("those of `observations.qpos`"), "{said}");
    // no time is recorded but a frame's number, at 30 a second
    let second = "0.03333333333333333,0,0.01,0.02,0.03,0.5";
    assert_eq!(rows.lines().nth(2), Some(second));
    let (said, rows) = imported(&other, &["--units", "radians", "--joints", "3,1"]);
    assert!(said.contains("left out: 2, 4"), "{said}");
    assert_eq!(rows.lines().nth(2), Some("0.03333333333333333,0,0.03,0.01"));
    let keys = ["--units", "radians", "--state", "observations.qvel"];
    assert_eq!(
        imported(&other, &keys).1.lines().nth(2),
        Some("0.03333333333333333,0,0.3,0.6,0.9,0")
    );

    // an arm of the same servos, listed from the hand
    let arm = folder.path().join("arm.toml");
    let joints = [
        "wrist_roll",
        "Wrist-Flex",
        "elbow_flex_joint",
        "shoulder_lift",
        "shoulder_pan",
    ];
    let joints = joints.map(|name| format!("[[joint]]\nname = \"{name}\"\n"));
    std::fs::write(&arm, joints.concat()).unwrap();
    let (_, all) = imported(&dataset(), &["--units", "degrees"]);
    let flags = ["--units", "degrees", "--device", arm.to_str().unwrap()];
    let (said, ordered) = imported(&dataset(), &flags);
    assert!(said.contains("left out: gripper"), "{said}");
    let cell = |text: &str, column: usize| {
        let line = text.lines().nth(40).unwrap();
        line.split(',').nth(column).unwrap().to_owned()
    };
    assert!(all.starts_with("t_s,run,theta1_rad"), "{all}");
    for joint in 0..5 {
        assert_eq!(cell(&ordered, 2 + joint), cell(&all, 6 - joint));
        assert_eq!(cell(&ordered, 7 + joint), cell(&all, 12 - joint));
    }
}
