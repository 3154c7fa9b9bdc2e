//! Encoders of 20 000 counts, read so often that a reading rests within a count for several rows.

use haptical::diagnosis::Verdict;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};
use haptical::{Device, Diagnose, Log, diagnose};

fn fixture(name: &str) -> Device {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices");
    let text = std::fs::read_to_string(format!("{folder}/{name}")).unwrap();
    Device::from_toml(&text, name).unwrap()
}

/// Rounding that rests where the arm is slow was a slow gap: three of the four fast ones were `unknown` when each row counted as a
/// reading.
#[test]
fn rounding_of_a_fast_log_is_no_gap() {
    let (device, truth) = (
        fixture("haptic7.toml"),
        fixture("haptic7-deviating.toml").model,
    );
    let effects = Effects::from_toml("", "effects.toml").unwrap();
    for (rate_hz, seed) in [
        (300.0, 1),
        (1000.0, 1),
        (1000.0, 2),
        (1000.0, 3),
        (1000.0, 4),
    ] {
        let settings = MotionSettings {
            motion: HandMotion {
                seconds: 20.0,
                rate_hz,
                ..HandMotion::default()
            },
            ..MotionSettings::default()
        };
        let recording = record_motion(&truth, &effects, &settings, seed).unwrap();
        let encoder = recording.output[0].as_ref().unwrap();
        let unchanged = encoder.windows(2).filter(|pair| pair[0] == pair[1]);
        assert!(3 * unchanged.count() > encoder.len());
        let log = Log::from_recording(recording, "log.csv", &device).unwrap();
        let found = diagnose(&device, &log, &Diagnose::default()).unwrap();
        let found = found.diagnosis;
        assert_eq!(
            found.verdict,
            Verdict::NoGap,
            "{rate_hz} Hz, seed {seed}: {:?} {:?}",
            found.place,
            found.causes
        );
    }
}
