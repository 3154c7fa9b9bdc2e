//! A base model that makes up for a cause by lengths and angles of another device.

use haptical::diagnosis::Verdict;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};
use haptical::{Device, Diagnose, Log, Truth, diagnose, true_device};

/// Without the cause the links are off by up to 0.9 rad. A search from there ended on its way: of the first device nothing was said of
/// unseen rows, and the third was `unknown`.
#[test]
fn a_cause_that_bends_the_base_model_is_named_and_corrected() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices");
    let text = std::fs::read_to_string(format!("{root}/haptic7.toml")).unwrap();
    let device = Device::from_toml(&text, "haptic7.toml").unwrap();
    let effects =
        "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n";
    let effects = Effects::from_toml(effects, "effects.toml").unwrap();
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 20.0,
            rate_hz: 300.0,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    // the first one's cable still keeps 6 % more on a replay than in the fit
    for (seed, is_corrected) in [(1, false), (3, true)] {
        let truth = true_device(&device, Truth::Drawn(0.3), seed).unwrap();
        let recording = record_motion(&truth, &effects, &settings, seed).unwrap();
        let log = Log::from_recording(recording, "log.csv", &device).unwrap();
        let found = diagnose(&device, &log, &Diagnose::default()).unwrap();
        assert!(found.corrected_toml().is_some() || !is_corrected, "{seed}");
        let found = found.diagnosis;
        assert_eq!(found.verdict, Verdict::Named, "{seed}: {:?}", found.causes);
        let cause = &found.causes[0];
        let name = (cause.effect.as_str(), cause.joint);
        assert_eq!(name, ("capstan-compliance", Some(2)), "{seed}");
        let [low, high] = cause.parameters["stiffness_nm_per_rad"].ci95;
        assert!((low..high).contains(&260.0), "{seed}: {low} to {high}");
        let unseen = cause
            .held_out
            .as_ref()
            .and_then(|held_out| held_out.reduction_percent);
        assert!(
            unseen.is_some_and(|closed| closed > 98.0),
            "{seed}: {unseen:?}"
        );
    }
}
