//! A calibrated device in a control loop: pose and joint torques of one step, without allocation.
//!
//! `cargo run -p haptical --example control_loop`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::runtime::{Capstan, Convention, Joint, Link, Model, Motion, Transmission};

/// In a controller this is what `haptical export --format rust` wrote, worked out by the compiler.
const ROW: Link = Link {
    a_m: 0.3,
    alpha_rad: 0.0,
    d_m: 0.0,
    theta_rad: 0.0,
    beta_rad: 0.0,
    b_m: 0.0,
};
const DRIVE: Transmission = Transmission::Capstan(Capstan {
    transmission_ratio: 8.0,
    drum_distance_m: 0.0675,
    input_drum_denominator_m: 0.0675,
    offset: 0.0,
    ratio_deviation: 0.02,
    output_drum_xy_m: [2e-4, 0.0],
    input_drum_xy_m: [0.0, 0.0],
});
const JOINT: Joint = Joint {
    motion: Motion::Revolute,
    home: 0.0,
    transmission: DRIVE,
};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let base = Link { a_m: 0.0, ..ROW };
    let model = Model::new(Convention::Standard, base, [ROW; 2], [JOINT; 2])?;
    for step in 0..1000 {
        let readings = [0.3 + 1e-4 * f64::from(step), 0.8];
        let state = model.step(&readings)?;
        // a virtual wall at x = 0.35 m pushes back with 500 N/m
        let push_n = 500.0 * (0.35 - state.pose.position_m[0]).max(0.0);
        let torques_nm = state.reading_torques_nm([push_n, 0.0, 0.0], [0.0; 3])?;
        assert!(torques_nm.iter().all(|torque| torque.abs() <= 0.7 * push_n));
        if step == 999 {
            println!("{:?} m, {torques_nm:?} Nm", state.pose.position_m);
        }
    }
    Ok(())
}
