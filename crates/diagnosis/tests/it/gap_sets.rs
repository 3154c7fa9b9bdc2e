//! The labelled sets of an independent simulator, where they are at hand: each answered rightly, as it is
//! and disturbed.

use std::path::{Path, PathBuf};

use haptical_data::{JointShape, LogShape, read_log};
use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, JointType, Recording};

use crate::arm::{assert_near, every, summary};
use crate::normal::Normal;

/// Where the sets lie: `HAPTICAL_SHARED`, or next to the workspace.
fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("HAPTICAL_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let path = folder.join(path);
    if !path.exists() {
        println!("skipped: {} is absent", path.display());
        return None;
    }
    Some(path)
}

/// A set as it was delivered.
struct Set {
    device: Device,
    recording: Recording,
    truth: serde_json::Value,
}

fn set(name: &str) -> Option<Set> {
    let folder = shared(&format!("gap-sets/{name}"))?;
    let text = std::fs::read_to_string(shared("devices/haptic7.toml")?).unwrap();
    let device = Device::from_toml(&text, "haptic7.toml").unwrap().device;
    let joints = device.joints.iter().map(|joint| JointShape {
        name: joint.name.clone(),
        prismatic: joint.joint_type == JointType::Prismatic,
        lower: joint.lower_rad,
        upper: joint.upper_rad,
    });
    let shape = LogShape {
        joints: joints.collect(),
        cable_count: 1,
        hands: Vec::new(),
    };
    let recording = read_log(&folder.join("log.csv.gz"), &shape)
        .unwrap()
        .recording;
    let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    Some(Set {
        device,
        recording,
        truth: serde_json::from_str(&truth).unwrap(),
    })
}

/// Whether an answer is the one that the set accepts, at its joint, without a cause too many.
fn is_right(truth: &serde_json::Value, diagnosis: &Diagnosis) -> bool {
    let right: Vec<Vec<String>> = serde_json::from_value(truth["right"].clone()).unwrap();
    let Some(accepted) = right.first() else {
        return diagnosis.verdict == Verdict::NoGap;
    };
    let joint = truth["joint"].as_u64().map(|joint| joint as usize);
    if accepted == &["unknown"] {
        let place = diagnosis.place.as_ref().and_then(|place| place.joint);
        return diagnosis.verdict == Verdict::Unknown && place == joint;
    }
    // noise that was added is louder than stated, and may be said to be
    let of_noise = ["noise-level", "outliers"];
    let mechanical: Vec<_> = diagnosis
        .causes
        .iter()
        .filter(|cause| !of_noise.contains(&cause.effect.as_str()))
        .collect();
    diagnosis.verdict.has_causes()
        && mechanical.len() == 1
        && accepted.contains(&mechanical[0].effect)
        && mechanical[0].joint == joint
}

/// The answer to a set, and whether it is right; none where the set is not at hand.
fn answered(name: &str, disturb: impl Fn(&Recording) -> Recording) -> Option<(Diagnosis, bool)> {
    let set = set(name)?;
    let recording = disturb(&set.recording);
    let diagnosis = diagnose(&set.device, &recording, &Options::default()).unwrap();
    let right = is_right(&set.truth, &diagnosis);
    Some((diagnosis, right))
}

fn assert_answered(name: &str, disturb: impl Fn(&Recording) -> Recording) -> Option<Diagnosis> {
    let (diagnosis, right) = answered(name, disturb)?;
    assert!(right, "{name}: {}", summary(&diagnosis));
    Some(diagnosis)
}

/// 30 um of noise more on the cable.
fn with_a_noisy_cable(recording: &Recording) -> Recording {
    let mut recording = recording.clone();
    let mut noise = Normal::new(30);
    for value in recording.cable_m[0].as_mut().unwrap() {
        *value += 30e-6 * noise.next();
    }
    recording
}

fn halved(recording: &Recording) -> Recording {
    every(recording, 2)
}

/// Value and interval of the first cause's parameter.
fn parameter(diagnosis: &Diagnosis, name: &str) -> (f64, [f64; 2]) {
    let answer = diagnosis.causes[0].parameters[name];
    (answer.value, answer.ci95)
}

#[test]
fn set_01_clean() {
    assert_answered("01-clean", Recording::clone);
}

#[test]
fn set_02_capstan_compliance() {
    if let Some(diagnosis) = assert_answered("02-capstan-compliance", Recording::clone) {
        assert_near(parameter(&diagnosis, "stiffness_nm_per_rad"), 260.0);
    }
}

#[test]
fn set_03_backlash() {
    if let Some(diagnosis) = assert_answered("03-backlash", Recording::clone) {
        let (width_rad, _) = parameter(&diagnosis, "width_rad");
        assert!((width_rad - 1.2e-3).abs() < 0.05e-3, "{width_rad}");
    }
}

#[test]
fn set_04_cable_latency() {
    if let Some(diagnosis) = assert_answered("04-cable-latency", Recording::clone) {
        assert_near(parameter(&diagnosis, "delay_s"), 4e-3);
    }
}

#[test]
fn set_05_count_loss() {
    if let Some(diagnosis) = assert_answered("05-count-loss", Recording::clone) {
        let (counts, _) = parameter(&diagnosis, "counts");
        assert!((counts.abs() - 60.0).abs() < 1.0, "{counts}");
        let (time_s, _) = parameter(&diagnosis, "time_s");
        assert!((time_s - 25.355).abs() < 0.1, "{time_s}");
    }
}

#[test]
fn set_06_joint_compliance() {
    if let Some(diagnosis) = assert_answered("06-joint-compliance", Recording::clone) {
        assert_near(parameter(&diagnosis, "stiffness_nm_per_rad"), 420.0);
    }
}

#[test]
fn set_07_cable_guide() {
    assert_answered("07-cable-guide", Recording::clone);
}

#[test]
fn set_08_unknown_dent() {
    if let Some(diagnosis) = assert_answered("08-unknown-dent", Recording::clone) {
        let place = diagnosis.place.unwrap();
        assert_eq!(
            place.depends_on.first().map(String::as_str),
            Some("theta2_rad")
        );
        assert!(place.region.contains("0.2"), "{}", place.region);
    }
}

const SETS: [&str; 8] = [
    "01-clean",
    "02-capstan-compliance",
    "03-backlash",
    "04-cable-latency",
    "05-count-loss",
    "06-joint-compliance",
    "07-cable-guide",
    "08-unknown-dent",
];

fn assert_all_answered(disturb: impl Fn(&Recording) -> Recording) {
    let wrong: Vec<String> = SETS
        .into_iter()
        .filter_map(|name| match answered(name, &disturb) {
            Some((diagnosis, false)) => Some(format!("{name}: {}", summary(&diagnosis))),
            _ => None,
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn half_the_rows_are_answered_alike() {
    assert_all_answered(halved);
}

#[test]
fn a_noisy_cable_is_answered_alike() {
    assert_all_answered(with_a_noisy_cable);
}

#[test]
fn half_the_rows_with_a_noisy_cable_are_answered_alike() {
    assert_all_answered(|recording| halved(&with_a_noisy_cable(recording)));
}
