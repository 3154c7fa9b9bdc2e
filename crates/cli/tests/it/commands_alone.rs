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
    assert_eq!((&said["rows"], &said["joints"]), (&600.into(), &6.into()));
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
    assert_eq!(first["parameters"]["from_run"]["value"], 3.0, "{first}");
    let region = answer["where"]["region"].as_str().unwrap();
    assert!(region.contains("between runs 2 and 3"), "{region}");
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
    // 10 % of a gripper whose 100 % are 1.92 rad, from -0.17 rad on: of the first row's command, 8 sin 0 + 20 sin 5
    let first = std::fs::read_to_string(&log).unwrap();
    let first: Vec<f64> = first
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .map(|cell| cell.parse().unwrap_or(f64::NAN))
        .collect();
    let expected = -0.17 + 0.0192 * 20.0 * 5.0_f64.sin();
    assert!((first[13] - expected).abs() < 1e-5, "{first:?}");
}
