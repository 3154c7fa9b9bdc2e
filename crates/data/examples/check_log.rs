//! Reads a log and prints what is in it, or what is wrong with it.
//!
//! `cargo run -p haptical-data --example check_log [-- LOG N_JOINTS]`

use std::path::Path;

use haptical_data::{DataError, JointShape, LoadedLog, LogShape, read_log, read_log_from};

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn show(result: Result<LoadedLog, DataError>) {
    let log = match result {
        Ok(log) => log,
        Err(error) => return println!("{}\n  {error}\n", error.kind()),
    };
    let recording = &log.recording;
    println!("{} rows, {} joints", recording.len(), recording.joint.len());
    for (joint, readings) in recording.joint.iter().enumerate() {
        let low = readings.iter().copied().fold(f64::INFINITY, f64::min);
        let high = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        println!("  theta{}: {low} to {high} rad", joint + 1);
    }
    let outputs = recording.output.iter().flatten().count();
    let cables = recording.cable_m.iter().flatten().count();
    println!("  external encoders: {outputs}, cables: {cables}");
    for warning in &log.warnings {
        println!("  warning: {warning}");
    }
    println!();
}

/// A device whose revolute joints all turn a quarter turn to either side.
fn device(n_joints: usize) -> LogShape {
    let limit = std::f64::consts::FRAC_PI_2;
    let joint = |index: usize| JointShape {
        name: index.to_string(),
        prismatic: false,
        lower: -limit,
        upper: limit,
    };
    LogShape {
        joints: (1..=n_joints).map(joint).collect(),
        cable_count: 1,
        hands: Vec::new(),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [path, n_joints] = arguments.as_slice()
        && let Ok(n_joints) = n_joints.parse()
    {
        return show(read_log(Path::new(path), &device(n_joints)));
    }
    for text in [
        "t_s,theta1_rad,cable_m,humidity\n0,0.1,0.25,40\n0.01,0.2,,41\n",
        "t_s,theta1,cable_m\n0,0.1,0.25\n0.01,0.2,0.26\n",
        "t_s,theta1_rad,cable_m\n0,-40,0.25\n0.01,85,0.26\n",
        "t_s,theta1_rad\n0,0.1\n0.01,abc\n",
        "t_s,theta1_rad\n0.01,0.1\n0,0.2\n",
    ] {
        show(read_log_from(text.as_bytes(), "log.csv", &device(1)));
    }
}
