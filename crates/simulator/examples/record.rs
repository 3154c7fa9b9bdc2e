//! Records a joint with a cable drive whose ratio is off, and prints what its two encoders show.
#![allow(clippy::print_stdout, reason = "an example prints its result")]

use std::error::Error;

use haptical_simulator::model::Device;
use haptical_simulator::{Settings, apply_deviations, simulate, true_poses};

/// A device file: an arm of 0.3 m on one capstan, watched by a cable from the base.
const DEVICE: &str = r#"
[device]
name = "one joint"

[[link]]
a_m = 0.1
alpha_rad = 0.0
d_m = 0.2
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0

[[joint]]
lower_rad = -1.2
upper_rad = 1.2
sampling_sd_rad = 0.4
transmission = "capstan"
transmission_ratio = 8.0
drum_distance_m = 0.0675
encoder_counts_per_rev = 20000
external_encoder_counts_per_rev = 20000

[cable_encoder]
drum_radius_m = 0.015
counts_per_rev = 20000
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let nominal = Device::from_toml(DEVICE, "device.toml")?.device;
    let deviations = [
        ("ratio_deviation1", -0.025),
        ("output_drum_y1", 2e-4),
        ("a1", 1e-3),
    ];
    let truth = apply_deviations(&nominal, &deviations)?;
    let recording = simulate(&truth, &Settings::real_encoders(), 8, 1)?;
    let poses = true_poses(&truth, &recording)?;

    println!("line  motor-side encoder  external encoder  cable encoder  true distance");
    println!("                     rad               rad              m              m");
    let (outputs, cable_m) = (&recording.output[0], &recording.cable_m[0]);
    let columns = outputs.iter().flatten().zip(cable_m.iter().flatten());
    for (row, (output, distance_m)) in columns.enumerate() {
        println!(
            "{:4}  {:18.6}  {output:16.6}  {distance_m:13.7}  {:13.7}",
            recording.line[row],
            recording.joint[0][row],
            poses[row].position_m.norm()
        );
    }
    Ok(())
}
