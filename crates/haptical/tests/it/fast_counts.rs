//! Encoders of 20 000 counts, read so often that a reading rests within a count for several rows.

use haptical::diagnosis::{Diagnosis, NoiseSource, Verdict};
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};
use haptical::{Device, Diagnose, Log, diagnose};

fn fixture(name: &str) -> Device {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices");
    let text = std::fs::read_to_string(format!("{folder}/{name}")).unwrap();
    Device::from_toml(&text, name).unwrap()
}

/// 20 s of the built device, at least a third of whose readings are those of the row before.
fn diagnosed(effects: &str, rate_hz: f64, seed: u64) -> Diagnosis {
    let (device, truth) = (
        fixture("haptic7.toml"),
        fixture("haptic7-deviating.toml").model,
    );
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 20.0,
            rate_hz,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let effects = Effects::from_toml(effects, "effects.toml").unwrap();
    let recording = record_motion(&truth, &effects, &settings, seed).unwrap();
    let encoder = recording.output[0].as_ref().unwrap();
    let unchanged = encoder.windows(2).filter(|pair| pair[0] == pair[1]);
    assert!(3 * unchanged.count() > encoder.len());
    let log = Log::from_recording(recording, "log.csv", &device).unwrap();
    let found = diagnose(&device, &log, &Diagnose::default()).unwrap();
    found.diagnosis
}

/// Rounding that rests where the arm is slow was a slow gap: three of the four fast ones were `unknown` when each row counted as a
/// reading.
#[test]
fn rounding_of_a_fast_log_is_no_gap() {
    for (rate_hz, seed) in [
        (300.0, 1),
        (1000.0, 1),
        (1000.0, 2),
        (1000.0, 3),
        (1000.0, 4),
    ] {
        let found = diagnosed("", rate_hz, seed);
        assert_eq!(
            found.verdict,
            Verdict::NoGap,
            "{rate_hz} Hz, seed {seed}: {:?} {:?}",
            found.place,
            found.causes
        );
        for channel in &found.gap.channels[..4] {
            assert_eq!(channel.noise_source, NoiseSource::Counts);
            let [low, high] = channel.noise_floor_ci95;
            assert!(
                (low..high).contains(&channel.rms_before) && high < 2.0 * low,
                "{rate_hz} Hz, seed {seed}: {channel:?}"
            );
        }
    }
}

/// What counts hide is small: a cable that yields by a few counts is found as in a slow log.
#[test]
fn a_yielding_cable_in_a_fast_log_is_named() {
    let effect =
        "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 1000.0\n";
    let found = diagnosed(effect, 1000.0, 1);
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.causes);
    let cause = &found.causes[0];
    assert_eq!(
        (cause.effect.as_str(), cause.joint),
        ("capstan-compliance", Some(2))
    );
    let stiffness = &cause.parameters["stiffness_nm_per_rad"];
    let [low, high] = stiffness.ci95;
    assert!((low..high).contains(&1000.0), "{stiffness:?}");
}
