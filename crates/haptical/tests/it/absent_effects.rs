//! An effect that the log does not have, fitted all the same: noise gives it either sign.

use haptical::model::Device as Model;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};
use haptical::{Device, EffectEntry, Identify, Log, identify};

/// Names that come out negative on half of the logs, though a device has none of them below zero.
const POSITIVE: [&str; 2] = ["viscous-lag@2", "base-compliance"];
const LOGS: u64 = 4;

fn entry(text: &str, truth: &Model, word: &str, seed: u64) -> (EffectEntry, Model) {
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 20.0,
            rate_hz: 25.0,
            rests: 1,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let recording = record_motion(truth, &Effects::none(), &settings, seed).unwrap();
    let device = Device::from_toml(text, "device.toml").unwrap();
    let log = Log::from_recording(recording, "log.csv", &device).unwrap();
    let options = Identify {
        with: vec![word.to_owned()],
        ..Identify::default()
    };
    let found = identify(&device, &log, &options).unwrap();
    let entry = found.result.effects[0].clone();
    (entry, found.device.model)
}

#[test]
fn an_effect_that_noise_makes_negative_is_not_shown_and_no_error() {
    let devices = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices");
    let read = |name: &str| std::fs::read_to_string(format!("{devices}/{name}")).unwrap();
    let (text, true_text) = (read("haptic7.toml"), read("haptic7-deviating.toml"));
    let truth = Device::from_toml(&true_text, "truth.toml").unwrap().model;
    let mut impossible = 0;
    for word in POSITIVE {
        for seed in 0..LOGS {
            let (entry, model) = entry(&text, &truth, word, seed);
            assert!(!entry.shown, "{word} of log {seed}: {entry:?}");
            assert!(model.effects.is_empty(), "what is not shown is left out");
            impossible += usize::from(entry.why.contains("sign"));
        }
    }
    assert!(impossible > 0, "no log gave a negative effect");
}
