//! Pose, Jacobian and holding torques of an arm with two turns and one linear joint.
#![allow(clippy::print_stdout, reason = "an example shows its results")]

use std::f64::consts::FRAC_PI_2;

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{
    Chain, Convention, KinematicsError, Link, LinkDerivatives, Motion, Parameter, Twist,
    distance_derivative, distance_m, joint_torques_nm,
};

fn main() -> Result<(), KinematicsError> {
    let links = [
        Link {
            alpha_rad: -FRAC_PI_2,
            d_m: 0.4,
            ..Link::default()
        },
        Link {
            alpha_rad: FRAC_PI_2,
            ..Link::default()
        },
        Link {
            a_m: 0.05,
            ..Link::default()
        },
    ];
    let motions = [Motion::Revolute, Motion::Revolute, Motion::Prismatic];
    let chain = Chain::new(Convention::Standard, &links, &motions)?;
    let joints = [0.3, 1.2, 0.5]; // rad, rad, m

    let mut jacobian = [Twist::default(); 3];
    let pose = chain.geometric_jacobian(&joints, &mut jacobian)?;
    println!("position of the end: {:.6?} m", pose.position_m.as_slice());
    for (joint, column) in jacobian.iter().enumerate() {
        let (linear, angular) = (column.linear.as_slice(), column.angular.as_slice());
        println!("joint {joint}: linear {linear:.4?}, angular {angular:.4?}");
    }

    let mut torques = [0.0; 3];
    joint_torques_nm(
        &jacobian,
        &Vector3::new(0.0, 0.0, 2.0),
        &Vector3::zeros(),
        &mut torques,
    )?;
    println!("to push upwards with 2 N: {torques:.4?} (Nm, Nm, N)");

    let anchor_m = Vector3::zeros();
    let mut derivatives = [LinkDerivatives::default(); 3];
    chain.derivatives(&joints, &mut derivatives)?;
    println!(
        "distance from the base: {:.6} m",
        distance_m(&pose.position_m, &anchor_m)?
    );
    for (row, link) in derivatives.iter().enumerate() {
        for parameter in Parameter::ALL {
            let rate = distance_derivative(&pose, &anchor_m, &link.get(parameter))?;
            println!(
                "  its derivative by {parameter}_{row}: {rate:+.6} m/{}",
                parameter.unit()
            );
        }
    }
    Ok(())
}
