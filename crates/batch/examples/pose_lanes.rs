//! Poses and Jacobians of many postures many times over, for counts of instructions and times
//! (README.md, Measured): `pose_lanes POSTURES PASSES`.
#![allow(clippy::print_stdout, reason = "an example shows its results")]

use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use std::time::Instant;

use haptical_batch::{BatchError, PoseLanes};
use haptical_kinematics::{Chain, Convention, Link, Motion};

const JOINTS: usize = 7;

fn main() -> Result<(), BatchError> {
    let mut arguments = std::env::args().skip(1);
    let mut count = || arguments.next()?.parse::<usize>().ok();
    let (postures, passes) = (count().unwrap_or(1000), count().unwrap_or(1));
    let mut motions = [Motion::Revolute; JOINTS + 1];
    motions[0] = Motion::Fixed;
    // nominal rows, a hundredth off, as after a calibration
    let links: [Link; JOINTS + 1] = std::array::from_fn(|row| {
        let off = 0.01 * (row as f64 - 3.3);
        let side = if row % 2 == 0 { 1.0 } else { -1.0 };
        Link {
            a_m: 0.05 * row as f64 + off,
            alpha_rad: side * FRAC_PI_2 + off,
            d_m: 0.1 * side + off,
            theta_rad: 0.2 * off,
            beta_rad: if row == 3 { off } else { 0.0 },
            b_m: 0.0,
        }
    });
    let chain = Chain::new(Convention::Standard, &links, &motions)?;
    let variable = |joint: usize, posture: usize| (0.37 * posture as f64 + joint as f64).sin();
    let joints_rad: [Vec<f64>; JOINTS] =
        std::array::from_fn(|joint| (0..postures).map(|each| variable(joint, each)).collect());
    let mut lanes = PoseLanes::<JOINTS>::new(&chain)?;
    let mut least_s = f64::INFINITY;
    for _ in 0..passes {
        let start = Instant::now();
        lanes.evaluate(black_box(&joints_rad))?;
        black_box(&lanes);
        least_s = least_s.min(start.elapsed().as_secs_f64());
    }
    let last = postures
        .checked_sub(1)
        .and_then(|posture| lanes.pose(posture));
    println!("pose of the last posture: {last:?}");
    println!(
        "least time: {:.1} ns a posture",
        1e9 * least_s / postures as f64
    );
    Ok(())
}
