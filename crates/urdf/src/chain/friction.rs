//! Friction that a description states of its joints.

use haptical_model::{DeviceEffect, FrictionNumber, JOINT_FRICTION, JointType};

use crate::chain::Rows;
use crate::robot::{Robot, RobotJointType};

/// Speed over which friction changes sides, of which no description says anything \[rad/s\]: assumption A331.
const TURNOVER_RAD_PER_S: f64 = 0.02;
/// The same of a slide \[m/s\].
const TURNOVER_M_PER_S: f64 = 2e-3;

/// That speed for a kind of joint.
pub(crate) fn turnover_per_s(joint_type: JointType) -> f64 {
    match joint_type {
        JointType::Prismatic => TURNOVER_M_PER_S,
        JointType::Revolute => TURNOVER_RAD_PER_S,
    }
}

/// Coulomb's friction and that per speed of one of the device's joints, with those of the rows that follow it, seen at the joint.
pub(crate) fn friction(robot: &Robot, rows: &Rows, number: usize) -> [f64; 2] {
    let entry = rows.rows.iter().filter(|row| row.drive.joint == number);
    entry.fold([0.0; 2], |[coulomb, viscous], row| {
        let [dry, wet] = robot.joints[row.joint].friction;
        let multiplier = row.drive.multiplier.abs();
        [
            coulomb + multiplier * dry,
            viscous + multiplier * multiplier * wet,
        ]
    })
}

/// The frictions as effects of a device.
pub(crate) fn frictions(robot: &Robot, rows: &Rows) -> Vec<DeviceEffect> {
    let of = |(number, driver): (usize, &usize)| {
        let [coulomb, viscous] = friction(robot, rows, number);
        if coulomb <= 0.0 && viscous <= 0.0 {
            return None;
        }
        let joint_type = match robot.joints[*driver].joint_type {
            RobotJointType::Prismatic => JointType::Prismatic,
            _ => JointType::Revolute,
        };
        let numbers = [
            (FrictionNumber::Coulomb, coulomb),
            (FrictionNumber::Viscous, viscous),
            (FrictionNumber::Stribeck, 0.0),
            (FrictionNumber::TurnoverSpeed, turnover_per_s(joint_type)),
        ];
        let numbers = numbers.map(|(entry, value)| (entry.key(joint_type).to_owned(), value));
        Some(DeviceEffect {
            name: JOINT_FRICTION.to_owned(),
            joint: Some(number),
            numbers: numbers.into(),
            ..DeviceEffect::default()
        })
    };
    let drivers = rows.drivers.iter().enumerate();
    drivers.filter_map(of).collect()
}
