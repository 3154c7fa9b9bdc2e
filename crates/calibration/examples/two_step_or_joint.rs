//! Calibrates a three-joint arm from simulated distances, in two steps and all at once.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "an example prints, and its numbers are known to be sound"
)]

use haptical_calibration::{CalibrationMethod, Channel, Options, calibrate};
use haptical_model::{Device, Evaluation, Parameter, ParameterId, Recording};

const ARM: &str = r#"
[[link]]
a_m = 0.2
alpha_rad = 0.9
d_m = 0.0
[[link]]
a_m = 0.1
alpha_rad = -1.2
d_m = 0.3
[[link]]
a_m = 0.25
alpha_rad = 0.7
d_m = 0.1
[[link]]
a_m = 0.15
alpha_rad = 0.0
d_m = 0.05
[[joint]]
transmission = "capstan"
transmission_ratio = 8.0
drum_distance_m = 0.07
external_encoder_sd_rad = 1e-4
[[joint]]
[[joint]]
[cable_encoder]
distance_sd_m = 1e-5
"#;

const ROWS: usize = 400;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nominal = Device::from_toml(ARM, "arm.toml")?.device;
    let mut truth = nominal.clone();
    let link = |row, parameter| ParameterId::Link { row, parameter };
    let ratio = ParameterId::Transmission { joint: 0, index: 1 };
    for (parameter, deviation) in [
        (link(1, Parameter::Theta), 8e-3),
        (link(2, Parameter::A), -1.2e-3),
        (link(2, Parameter::Alpha), 5e-3),
        (link(3, Parameter::D), 9e-4),
        (ratio, 0.05),
    ] {
        parameter.set(&mut truth, parameter.value(&nominal) + deviation);
    }
    let recording = record(&truth)?;
    for method in [CalibrationMethod::TwoStep, CalibrationMethod::Joint] {
        let options = Options {
            method,
            ..Options::default()
        };
        let calibration = calibrate(&nominal, &recording, &options)?;
        println!("{method:?}, {}", calibration.held_out);
        for channel in &calibration.held_out_channels {
            println!(
                "  {:6} rms {:.2e} -> {:.2e} {}",
                channel.channel, channel.rms_before, channel.rms_after, channel.unit
            );
        }
        let Some(fit) = &calibration.fitted.whole else {
            continue;
        };
        for (index, parameter) in fit.parameters.iter().enumerate() {
            let estimate = &fit.estimates[index];
            match (estimate.value, estimate.standard_deviation) {
                (Some(value), Some(sd)) => println!(
                    "  {:18} {value:11.6} +- {sd:.1e}, truth {:11.6} {}",
                    estimate.name,
                    parameter.value(&truth),
                    estimate.unit
                ),
                _ => println!(
                    "  {}",
                    fit.identifiability.reason(index).unwrap_or_default()
                ),
            }
        }
    }
    Ok(())
}

/// Readings over +-1.5 rad and what the true arm's sensors say, with noise.
fn record(truth: &Device) -> Result<Recording, Box<dyn std::error::Error>> {
    let mut recording = Recording {
        line: (2..2 + ROWS as u64).collect(),
        joint: vec![Vec::new(); 3],
        output: vec![Some(Vec::new()), None, None],
        cable_m: vec![Some(Vec::new())],
        ..Recording::default()
    };
    let mut evaluation = Evaluation::new(truth);
    for row in 0..ROWS {
        let readings: Vec<f64> = (0..3).map(|joint| 1.5 * spread(3 * row + joint)).collect();
        evaluation.move_to(&readings)?;
        for (column, reading) in recording.joint.iter_mut().zip(&readings) {
            column.push(*reading);
        }
        let sensors = [
            (Channel::Output { joint: 0 }, evaluation.output_rad(0), 1e-4),
            (
                Channel::Cable { index: 0 },
                evaluation.pose()?.position_m.norm(),
                1e-5,
            ),
        ];
        for (number, (channel, exact, sd)) in sensors.into_iter().enumerate() {
            let reading = exact + sd * noise(2 * row + number);
            match channel {
                Channel::Output { joint } => {
                    recording.output[joint].as_mut().unwrap().push(reading);
                }
                _ => recording.cable_m[0].as_mut().unwrap().push(reading),
            }
        }
    }
    Ok(recording)
}

/// Numbers in [-1, 1) without a visible order (SplitMix64).
fn spread(index: usize) -> f64 {
    let mut z = (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Nearly normal: a sum of twelve uniform numbers has variance 12 / 3 = 4 over +-1.
fn noise(index: usize) -> f64 {
    let sum: f64 = (0..12).map(|k| spread(1_000_000 + 12 * index + k)).sum();
    sum / 2.0
}
