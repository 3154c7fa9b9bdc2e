//! A capstan cable that stretches under its torque: the diagnosis names it, and says how stiff it is.
//!
//! `cargo run -p haptical --example diagnosis`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::prelude::*;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");
const STRETCH: &str =
    "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n";

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::load(format!("{FIXTURES}/devices/haptic7.toml"))?;
    let effects = Effects::from_toml(STRETCH, "effects.toml")?;
    let motion = HandMotion {
        seconds: 60.0,
        rate_hz: 20.0,
        ..HandMotion::default()
    };
    let settings = MotionSettings {
        motion,
        ..MotionSettings::default()
    };
    let recording = record_motion(&device.model, &effects, &settings, 1)?;
    let log = Log::from_recording(recording, "a hand's motion", &device)?;
    let gap = diagnose(&device, &log, &Diagnose::default())?;
    println!("{gap}");
    let cause = gap.named().ok_or("no cause is named")?;
    println!("{cause}");
    assert_eq!(cause.0.effect, "capstan-compliance");
    assert_eq!(cause.0.joint, Some(2));
    Ok(())
}
