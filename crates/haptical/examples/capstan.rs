//! One capstan drive and its external encoder: the terms of equation (1), each with its interval.
//!
//! `cargo run -p haptical --example capstan`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::data::Cells;
use haptical::prelude::*;

const DEVICE: &str = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n    drum_distance_m = 0.0675\nencoder_counts_per_rev = 20000\nexternal_encoder_counts_per_rev = 20000\n";

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::from_toml(DEVICE, "capstan.toml")?;
    // the drum of the output turns about a point 0.2 mm off its middle
    let readings: Vec<f64> = (0..400).map(|row| -1.4 + 0.007 * f64::from(row)).collect();
    let count_rad = std::f64::consts::TAU / 20000.0;
    let turned = |theta: &f64| theta + 2e-4 / 0.0675 * theta.sin();
    let output: Vec<f64> = readings
        .iter()
        .map(|theta| count_rad * (turned(theta) / count_rad).round())
        .collect();
    let columns = [
        ("theta1_rad", Cells::Numbers(&readings)),
        ("out1_rad", Cells::Numbers(&output)),
    ];
    let log = Log::from_columns(&columns, "a sweep", &device)?;
    let found = identify(&device, &log, &Identify::default())?;
    println!("{found}");
    let channel = &found.result.channels[0];
    assert!(channel.rms_after < 0.1 * channel.rms_before);
    assert!(
        found
            .result
            .parameters
            .iter()
            .any(|found| found.ci95.is_some())
    );
    Ok(())
}
