//! A capstan whose cable stretches: the diagnosis names it from motor and external encoder and the torque.
//!
//! `cargo run -p haptical-diagnosis --example name_the_cause`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical_diagnosis::{Options, diagnose};
use haptical_model::{Device, Recording};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n\
                drum_distance_m = 0.07\nencoder_counts_per_rev = 20000\n\
                external_encoder_sd_rad = 1e-4\n";
    let device = Device::from_toml(text, "one.toml")?.device;
    let (mut time_s, mut reading, mut torque, mut output) = (vec![], vec![], vec![], vec![]);
    for row in 0..3000_u32 {
        let t = 0.01 * f64::from(row);
        let angle = 0.9 * (0.9 * t).sin() + 0.3 * (2.3 * t).sin();
        let load = 0.8 * (0.7 * t).cos() - 0.4 * (1.9 * t).sin();
        // a stand-in for the noise of the external encoder
        let noise = 1e-4 * ((f64::from(row) * 12.9898).sin() * 43_758.547).fract();
        time_s.push(t);
        reading.push(angle);
        torque.push(load);
        output.push(angle - load / 250.0 + noise);
    }
    let recording = Recording {
        line: (2..3002).collect(),
        time_s: Some(time_s),
        joint: vec![reading],
        output: vec![Some(output)],
        torque_nm: vec![Some(torque)],
        ..Recording::default()
    };
    let diagnosis = diagnose(&device, &recording, &Options::default())?;
    println!("{}", diagnosis.verdict.name());
    for cause in &diagnosis.causes {
        println!(
            "{} at joint {:?}: {:?}",
            cause.effect, cause.joint, cause.parameters
        );
    }
    Ok(())
}
