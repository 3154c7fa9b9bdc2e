//! Trials as folders: what is written reads back, and the truth stays out when it is sealed.

use haptical_data::{LogShape, read_log};
use haptical_model::Device;
use xtask_blind::{Suite, Truth, write_moving, write_trial};

#[test]
fn a_folder_reads_back_as_the_trial() {
    let folder = tempfile::tempdir().expect("a folder");
    let trial = Suite::Singles.draw(31, 6).expect("a trial of two runs");
    write_trial(&trial, folder.path(), true).expect("files");
    let text = std::fs::read_to_string(folder.path().join("device.toml")).expect("a file");
    let device = Device::from_toml(&text, "device.toml")
        .expect("a device")
        .device;
    assert_eq!(device, trial.device);
    for (name, log) in [("log.csv.gz", &trial.log), ("log2.csv.gz", &trial.log2)] {
        let read = read_log(&folder.path().join(name), &LogShape::from(&device)).expect("a log");
        assert_eq!(&read.recording, log, "{name}");
    }
    let text = std::fs::read_to_string(folder.path().join("truth.json")).expect("a file");
    let truth: Truth = serde_json::from_str(&text).expect("a truth");
    assert_eq!(
        (truth.right, truth.joint),
        (trial.truth.right.clone(), trial.truth.joint)
    );
}

#[test]
fn a_sealed_folder_has_no_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let trial = Suite::Ablation.draw(0, 6).expect("a trial");
    write_trial(&trial, &folder.path().join("deep/down"), false).expect("files");
    let has = |name: &str| folder.path().join("deep/down").join(name).exists();
    assert!(has("model.toml") && has("log2.csv.gz") && !has("truth.json"));
}

/// Recordings of moving arms: counts, commands as columns beside, and for slides metres and newtons.
#[test]
fn a_moving_arm_reads_back_as_the_trial() {
    let mut slides = 0;
    for index in [0, 1, 17, 30, 50] {
        let folder = tempfile::tempdir().expect("a folder");
        let trial = Suite::Moving.draw(index, 6).expect("a trial");
        write_trial(&trial, folder.path(), true).expect("files");
        let shape = LogShape::from(&trial.device);
        for (name, log) in [("log.csv.gz", &trial.log), ("log2.csv.gz", &trial.log2)] {
            let read = read_log(&folder.path().join(name), &shape).expect("a log");
            assert_eq!(&read.recording, log, "{name}");
        }
        slides += trial
            .device
            .joints
            .iter()
            .filter(|joint| joint.unit() == "m")
            .count();
    }
    assert!(slides > 0, "no slide among them");
}

#[test]
fn a_moving_arm_is_written_with_what_its_user_knows() {
    let folder = tempfile::tempdir().expect("a folder");
    write_moving(2, 6, folder.path()).expect("files");
    let own = folder.path().join("moving-002-torque-gain");
    for name in [
        "device.toml",
        "arm.urdf",
        "arm.json",
        "log.csv.gz",
        "log2.csv.gz",
    ] {
        assert!(own.join(name).exists(), "{name}");
    }
    let text = std::fs::read_to_string(own.join("truth.json")).expect("a file");
    let truth: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let drawn = Suite::Moving.draw(2, 6).expect("a trial").truth;
    assert_eq!(truth["right"], serde_json::json!([["torque-gain"]]));
    assert_eq!(truth["effects"][0][0], "torque-gain");
    assert_eq!(truth["joint"], serde_json::json!(drawn.joint));
}
