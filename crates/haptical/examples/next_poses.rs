//! Twelve poses to measure next, in addition to those of a log, chosen for what the log says least about.
//!
//! `cargo run -p haptical --example next_poses`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::prelude::*;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::load(format!("{FIXTURES}/devices/haptic7.toml"))?;
    let log = Log::read(format!("{FIXTURES}/logs/haptic7-sample.csv"), &device)?;
    let request = Request {
        rigs: vec![Rig::parse("out,cable")?],
        candidates: 300,
        poses: 12,
        chooses: true,
        ..Request::default()
    };
    let planned = plan(&device, &request, Some(&log))?;
    let next = planned.next_poses().ok_or("no poses were chosen")?;
    for pose in &next.postures {
        println!("{:.3?}", pose.readings);
    }
    assert_eq!(next.postures.len(), 12);
    let random = next.random.as_ref().ok_or("nothing to compare with")?;
    assert!(next.figures.geometric_mean_sd <= random.geometric_mean_sd);
    Ok(())
}
