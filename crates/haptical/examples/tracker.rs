//! A device seen by a tracker: neither the place of the tracker nor that of its marker is known.
//!
//! `cargo run -p haptical --example tracker`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;

use haptical::files::Source;
use haptical::prelude::*;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

pub(crate) fn main() -> Result<(), Error> {
    let file = |name: &str| Source::given(&Path::new(FIXTURES).join(name));
    let equipment = Equipment {
        rig: Some(file("rigs/tracker.toml")),
        ..Equipment::default()
    };
    let device = Device::open(&file("devices/haptic7.toml"), &equipment)?;
    let log = Log::open(&file("logs/tracker.csv.gz"), &device)?;
    let found = identify(&device, &log, &Identify::default())?;
    println!("{found}");
    for channel in &found.result.channels {
        assert!(
            channel.rms_after < 1.1 * channel.noise_floor,
            "{}",
            channel.channel
        );
    }
    // the tracker's place and the device's first numbers are one and the same for these readings
    let base = found
        .result
        .parameters
        .iter()
        .find(|entry| entry.name == "a0");
    assert!(base.is_some_and(|entry| entry.status == "dependent"));
    Ok(())
}
