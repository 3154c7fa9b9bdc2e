//! Counts that a motor encoder loses while a hand moves a device, or lets it rest.

use haptical::diagnosis::{Diagnosis, Verdict};
use haptical::model::Recording;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};
use haptical::{Device, Diagnose, Log, diagnose};

fn fixture(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices");
    std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
}

/// A log of 40 s of the built device whose joint lost counts.
fn recorded(joint: usize, counts: f64, time_s: f64, seed: u64) -> Recording {
    let truth = Device::from_toml(&fixture("haptic7-deviating.toml"), "truth.toml").unwrap();
    let text = format!(
        "[[effect]]\nname = \"encoder-count-loss\"\njoint = {joint}\ncounts = {counts:?}\ntime_s = {time_s:?}\n"
    );
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 40.0,
            rate_hz: 25.0,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let effects = Effects::from_toml(&text, "effects.toml").unwrap();
    record_motion(&truth.model, &effects, &settings, seed).unwrap()
}

fn diagnosed(recording: Recording) -> Diagnosis {
    let device = Device::from_toml(&fixture("haptic7.toml"), "device.toml").unwrap();
    let log = Log::from_recording(recording, "log.csv", &device).unwrap();
    diagnose(&device, &log, &Diagnose::default())
        .unwrap()
        .diagnosis
}

/// The loss is named, with its one step, its size and its instant within their intervals.
fn assert_found(found: &Diagnosis, joint: usize, counts: f64, time_s: f64) {
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.causes);
    let cause = &found.causes[0];
    assert_eq!(
        (cause.effect.as_str(), cause.joint),
        ("encoder-count-loss", Some(joint))
    );
    assert_eq!(found.steps.len(), 1, "{:?}", found.steps);
    for (name, truth) in [("counts", counts), ("time_s", time_s)] {
        let [low, high] = cause.parameters[name].ci95;
        assert!(
            (low..=high).contains(&truth),
            "{name} {truth}: {low} to {high}"
        );
    }
    let count = &cause.parameters["counts"];
    assert!((count.value / counts - 1.0).abs() < 0.03, "{count:?}");
}

/// A rest is one block of rows, whose middle is no instant; a parallelogram turns by another angle than its motor says.
#[test]
fn counts_lost_at_rest_have_their_size_and_instant() {
    for (joint, counts, time_s, seed) in [
        (2, 30.0, 20.0, 1),
        (4, -300.0, 31.71, 29),
        (4, -300.0, 11.09, 4),
    ] {
        let recording = recorded(joint, counts, time_s, seed);
        assert_found(&diagnosed(recording), joint, counts, time_s);
    }
}

/// Twelve rows after the second of two runs began, the step is neither a constant nor another zero of that run.
#[test]
fn counts_lost_just_after_a_run_began_are_found() {
    const ROW: usize = 488;
    let mut recording = recorded(2, 30.0, 20.0, 1);
    let runs = 0..recording.len();
    recording.run = Some(runs.map(|row| i64::from(row >= ROW)).collect());
    assert_found(&diagnosed(recording), 2, 30.0, 20.0);
}
