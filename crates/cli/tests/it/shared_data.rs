//! Data from outside the project, where it is there; otherwise the tests say that they skip.

use std::path::PathBuf;

use crate::{haptical, text};

/// The folder of outside data next to the project, or a printed line.
fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared")
        .join(name);
    if path.exists() {
        Some(path)
    } else {
        println!("skipped: no {}", path.display());
        None
    }
}

fn identify(device: PathBuf, log: PathBuf) -> serde_json::Value {
    let out = tempfile::tempdir().unwrap();
    let output = haptical()
        .args(["identify", "--json", "--device"])
        .arg(device)
        .arg("--log")
        .arg(log)
        .arg("--out")
        .arg(out.path().join("result"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Held-out residuals of a clean recording may exceed the stated noise by the scatter of 1200
/// readings (2 %, one standard deviation) and by what the estimates' own spread adds.
const FLOOR_SHARE: f64 = 0.05;

#[test]
fn a_clean_recording_reaches_the_noise_floor() {
    let (Some(set), Some(devices)) = (shared("gap-sets/01-clean"), shared("devices")) else {
        return;
    };
    let result = identify(devices.join("haptic7.toml"), set.join("log.csv.gz"));
    let channels = result["channels"].as_array().unwrap();
    let names: Vec<&str> = channels
        .iter()
        .map(|channel| channel["channel"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["out1", "out2", "out3", "out4", "cable"]);
    for channel in channels {
        let after = channel["rms_after"].as_f64().unwrap();
        let floor = channel["noise_floor"].as_f64().unwrap();
        assert!((after / floor - 1.0).abs() < FLOOR_SHARE, "{channel}");
    }
}

/// Standard deviation of motor minus link side by the measurement's own description \[mrad\].
const TIAGO_SD_MRAD: [f64; 7] = [8.7, 4.7, 4.1, 13.2, 54.7, 18.4, 4.8];

#[test]
fn a_measured_arm_has_the_known_transmission_errors() {
    let Some(arm) = shared("measured/tiago_dual_encoder") else {
        return;
    };
    let result = identify(arm.join("device.toml"), arm.join("log.csv"));
    let channels = result["channels"].as_array().unwrap();
    assert_eq!(channels.len(), TIAGO_SD_MRAD.len());
    for (channel, known) in channels.iter().zip(TIAGO_SD_MRAD) {
        let before = 1e3 * channel["sd_before"].as_f64().unwrap();
        assert!((before - known).abs() < 0.1, "{channel}");
        let smaller = channel["rms_after"].as_f64() < channel["rms_before"].as_f64();
        assert!(smaller, "{channel}");
    }
    assert_eq!(result["transmissions"].as_array().unwrap().len(), 7);
}
