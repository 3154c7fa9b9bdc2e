//! Many devices of one kind in parallel, each from its own log: same numbers on any number of threads.
//!
//! `cargo run -p haptical --example fleet`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::prelude::*;
use rayon::prelude::*;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

pub(crate) fn main() -> Result<(), Error> {
    let device = Device::load(format!("{FIXTURES}/devices/haptic7.toml"))?;
    let log = Log::read(format!("{FIXTURES}/logs/haptic7-sample.csv"), &device)?;
    // in a workshop each device has a log of its own
    let logs = vec![log; 3];
    let found: Vec<Found> = logs
        .par_iter()
        .map(|log| identify(&device, log, &Identify::default()))
        .collect::<Result<_, Error>>()?;
    for one in &found {
        let channels = &one.result.channels;
        let worst = channels
            .iter()
            .map(|channel| channel.rms_after / channel.noise_floor);
        println!(
            "at most {:.2} noise floors are left",
            worst.fold(0.0, f64::max)
        );
        assert_eq!(one.to_toml(), found[0].to_toml());
    }
    Ok(())
}
