//! Origins of frames against products of 4 x 4 matrices written out here, and errors row by row.

use haptical_calibration::{
    CalibrationError, Channel, Weights, channel_residuals, channels, frame_origins_m,
};
use haptical_model::kinematics::nalgebra::{Matrix4, Rotation3, Translation3, Vector3};
use haptical_model::kinematics::{Convention, Link};
use haptical_model::{Device, JointType, ModelError, Recording};
use proptest::prelude::*;

use crate::chain::{ROWS, Rig, generic_chain, measure};

/// Rounding of a product of at most seven matrices with entries of about 1 \[m\].
const ROUNDING_M: f64 = 1e-13;

/// `A_i` of docs/notation.md: Rz Trans(0, 0, d) Trans(a, 0, 0) Rx [Ry], or Craig's order.
fn matrix(convention: Convention, link: &Link) -> Matrix4<f64> {
    let turn = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle).to_homogeneous();
    let shift = |x: f64, z: f64| Translation3::new(x, 0.0, z).to_homogeneous();
    let about_z = turn(Vector3::z(), link.theta_rad);
    let about_x = turn(Vector3::x(), link.alpha_rad);
    match convention {
        Convention::Modified => about_x * shift(link.a_m, 0.0) * about_z * shift(0.0, link.d_m),
        Convention::Standard => about_z * shift(link.a_m, link.d_m) * about_x,
    }
}

/// Origins by products from the left, the joint variables put into the rows by hand.
fn expected_m(device: &Device, readings: &[f64]) -> Vec<[f64; 3]> {
    let mut product = Matrix4::identity();
    let mut origins = vec![[0.0; 3]];
    for (row, link) in device.links.iter().enumerate() {
        let mut link = *link;
        if row > 0 {
            let joint = &device.joints[row - 1];
            let reading = readings[row - 1];
            let output = reading + joint.error_rad(reading).unwrap();
            match joint.joint_type {
                JointType::Revolute => link.theta_rad += joint.home_rad + output,
                JointType::Prismatic => link.d_m += joint.home_rad + output,
            }
        }
        product *= matrix(device.convention, &link);
        origins.push([product[(0, 3)], product[(1, 3)], product[(2, 3)]]);
    }
    origins
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Each frame is where the product of the rows before it puts it, for either convention, with
    /// homes, transmission errors and a sliding joint.
    #[test]
    fn every_frame_is_where_the_matrices_put_it(
        mut device in generic_chain(2..=6),
        modified in any::<bool>(),
        sliding in any::<bool>(),
        seed in any::<u64>(),
    ) {
        if modified {
            device.convention = Convention::Modified;
        }
        if sliding {
            device.joints[1].joint_type = JointType::Prismatic;
        }
        for (index, joint) in device.joints.iter_mut().enumerate() {
            joint.home_rad = 0.1 * (index as f64 + 1.0);
        }
        device.transmission_parameters(0)[0].set(&mut device, 0.02);
        let recording = measure(&device, Rig::Pose, 5, seed);
        let rows = frame_origins_m(&device, &recording).unwrap();
        prop_assert_eq!(rows.len(), recording.len());
        for (row, origins) in rows.iter().enumerate() {
            let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
            let expected = expected_m(&device, &readings);
            prop_assert_eq!(origins.len(), device.links.len() + 1);
            for (got, wanted) in origins.iter().zip(&expected) {
                for axis in 0..3 {
                    prop_assert!((got[axis] - wanted[axis]).abs() < ROUNDING_M);
                }
            }
            // exact measurements of the same device: the tracker saw the last origin
            let tracked = recording.position_m.as_ref().unwrap();
            for axis in 0..3 {
                prop_assert!((origins[device.links.len()][axis] - tracked[axis][row]).abs() < ROUNDING_M);
            }
        }
    }

    /// Errors row by row: signed for the cable, the distance for positions, none for empty cells.
    #[test]
    fn errors_stand_at_their_rows(
        device in generic_chain(2..=4),
        seed in any::<u64>(),
        gap in 0..ROWS,
    ) {
        let mut recording = measure(&device, Rig::Position, ROWS, seed);
        let cable = measure(&device, Rig::Cable, ROWS, seed);
        recording.cable_m = cable.cable_m;
        let shift_m = [3e-3, -4e-3, 12e-3];
        for (axis, shift) in recording.position_m.as_mut().unwrap().iter_mut().zip(shift_m) {
            for value in axis.iter_mut() {
                *value += shift;
            }
            axis[gap] = f64::NAN;
        }
        for value in recording.cable_m[0].as_mut().unwrap().iter_mut() {
            *value += 2e-3;
        }
        recording.cable_m[0].as_mut().unwrap()[gap] = f64::NAN;
        let channels = channels(&device, &recording).unwrap();
        let weights = Weights::stated(&device, &channels);
        let all = channel_residuals(&device, &device, &recording, &channels, &weights).unwrap();
        for channel in &all {
            let errors = channel.by_row(recording.len());
            prop_assert_eq!(errors.len(), ROWS);
            // model minus measurement: what was added to the measurement has the other sign
            let wanted_m = match channel.channel {
                Channel::Cable { .. } => -2e-3,
                _ => 13e-3,
            };
            for (row, error) in errors.iter().enumerate() {
                match error {
                    None => prop_assert_eq!(row, gap),
                    Some(error) => prop_assert!((error - wanted_m).abs() < 1e-12),
                }
            }
            prop_assert!(errors[gap].is_none());
            // a shorter answer drops rows and does not panic
            prop_assert_eq!(channel.by_row(1).len(), 1);
        }
    }
}

#[test]
fn a_device_without_links_has_no_frames() {
    let text = "[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";
    let device = Device::from_toml(text, "one.toml").unwrap().device;
    let recording = Recording {
        line: vec![2],
        joint: vec![vec![0.1]],
        output: vec![None],
        ..Recording::default()
    };
    let refused = frame_origins_m(&device, &recording).unwrap_err();
    assert!(
        matches!(
            refused,
            CalibrationError::Row {
                line: 2,
                source: ModelError::NoLinks { .. }
            }
        ),
        "{refused}"
    );
}
