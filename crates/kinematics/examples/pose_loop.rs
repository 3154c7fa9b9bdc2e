//! Pose and Jacobian many times over, for counts of instructions (README.md, Measured):
//! `pose_loop chain|prepared CALLS`.
#![allow(clippy::print_stdout, reason = "an example shows its results")]

mod arm;

use std::hint::black_box;

use haptical_kinematics::{Chain, Convention, KinematicsError, PreparedChain, Twist};

fn main() -> Result<(), KinematicsError> {
    let mut arguments = std::env::args().skip(1);
    let way = arguments.next().unwrap_or_default();
    let calls = arguments.next().and_then(|text| text.parse().ok());
    let calls: u32 = calls.unwrap_or(1);
    let links = arm::links();
    let chain = Chain::new(Convention::Standard, &links, &arm::MOTIONS)?;
    let prepared = PreparedChain::new(&chain)?;
    let mut jacobian = [Twist::default(); arm::JOINTS];
    let mut sum_m = 0.0;
    for _ in 0..calls {
        let posture = black_box(&arm::POSTURE_RAD);
        let pose = match way.as_str() {
            "chain" => chain.geometric_jacobian(posture, &mut jacobian)?,
            _ => prepared.pose_and_jacobian(posture, &mut jacobian)?,
        };
        sum_m += black_box(pose).position_m.x;
        black_box(&jacobian);
    }
    println!("mean x: {:.17} m", sum_m / f64::from(calls));
    Ok(())
}
