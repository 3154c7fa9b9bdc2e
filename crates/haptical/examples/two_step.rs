//! Transmissions first, from external encoders, and then the kinematics, from one cable.
//!
//! `cargo run -p haptical --example two_step`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::prelude::*;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

pub(crate) fn main() -> Result<(), Error> {
    let device = Device::load(format!("{FIXTURES}/devices/haptic7.toml"))?;
    let log = Log::read(format!("{FIXTURES}/logs/haptic7-sample.csv"), &device)?;
    let mut request = Identify::default();
    request.options.method = CalibrationMethod::TwoStep;
    let found = identify(&device, &log, &request)?;
    println!("{found}");
    for entry in &found.result.not_identified {
        println!("{}: {}", entry.name, entry.reason);
    }
    let cable = found
        .result
        .channels
        .iter()
        .find(|channel| channel.channel == "cable");
    assert!(cable.is_some_and(|cable| cable.rms_after < 0.02 * cable.rms_before));
    assert!(
        found
            .result
            .not_identified
            .iter()
            .any(|entry| entry.name == "alpha0")
    );
    Ok(())
}
