//! The chain with flex against the model's chain, and the devices' perturbation.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation};
use xtask_blind::{Chain, Flex, NOMINALS, Random, perturbed};

const ROUNDING_M: f64 = 1e-14;

fn outputs(device: &Device, random: &mut Random) -> Vec<f64> {
    let joints = device.joints.iter();
    joints
        .map(|joint| random.uniform(joint.lower_rad, joint.upper_rad))
        .collect()
}

#[test]
fn rigid_chain_is_the_models() {
    for nominal in NOMINALS {
        let mut random = Random::new(5, 0);
        let device = perturbed(&nominal.device().expect("a device"), &mut random);
        let chain = Chain::new(&device);
        let mut evaluation = Evaluation::new(&device);
        for _ in 0..20 {
            let q = outputs(&device, &mut random);
            evaluation.move_outputs(&q).expect("a pose");
            let expected = evaluation.pose().expect("a pose");
            let pose = chain.pose(|joint| q[joint], &Flex::default(), 0);
            assert!((pose.position_m - expected.position_m).norm() < ROUNDING_M);
            assert!((pose.rotation - expected.rotation).norm() < 10.0 * ROUNDING_M);
        }
    }
}

/// A tilt about z at a joint is a larger joint angle; one about x turns the rest about that frame's x.
#[test]
fn tilts_turn_what_lies_behind() {
    /// The tilt is exact to the second order.
    const THIRD_ORDER_M: f64 = 1e-9;
    let device = NOMINALS[0].device().expect("a device");
    let chain = Chain::new(&device);
    let q = [0.3, -0.2, 0.4, 0.1, -0.5, 0.2, 0.6];
    let joints = device.joints.len();
    let tilted = |joint: usize, tilt: [f64; 3]| {
        let mut flex = Flex {
            tilt_rad: vec![None; joints],
            tool_m: None,
        };
        flex.tilt_rad[joint] = Some(vec![tilt]);
        chain.pose(|joint| q[joint], &flex, 0).position_m
    };
    for joint in 0..joints {
        let turned = chain.pose(
            |other| q[other] + if other == joint { 1e-3 } else { 0.0 },
            &Flex::default(),
            0,
        );
        let about_z = tilted(joint, [0.0, 0.0, 1e-3]);
        assert!((about_z - turned.position_m).norm() < THIRD_ORDER_M);
        let rigid = chain.pose(|joint| q[joint], &Flex::default(), 0).position_m;
        let about_x = tilted(joint, [1e-3, 0.0, 0.0]) - rigid;
        assert!(about_x.norm() < 1e-3, "a lever below 1 m");
    }
}

#[test]
fn tool_shift_is_in_the_handles_frame() {
    let device = NOMINALS[1].device().expect("a device");
    let chain = Chain::new(&device);
    let q = [0.1, 0.2, -0.3, 0.4, -0.5, 0.6];
    let shift_m = [1e-3, -2e-3, 3e-3];
    let flex = Flex {
        tilt_rad: Vec::new(),
        tool_m: Some(vec![shift_m]),
    };
    let rigid = chain.pose(|joint| q[joint], &Flex::default(), 0);
    let moved = chain.pose(|joint| q[joint], &flex, 0);
    let expected = rigid.rotation * Vector3::from(shift_m);
    assert!((moved.position_m - rigid.position_m - expected).norm() < ROUNDING_M);
}

#[test]
fn manufactured_devices_differ_a_little_and_keep_home() {
    for nominal in NOMINALS {
        let drawing = nominal.device().expect("a device");
        let mut random = Random::new(77, 0);
        let (first, second) = (
            perturbed(&drawing, &mut random),
            perturbed(&drawing, &mut random),
        );
        assert_ne!(first, second);
        for (made, drawn) in first.links.iter().zip(&drawing.links) {
            assert!((made.a_m - drawn.a_m).abs() < 5e-3 && (made.d_m - drawn.d_m).abs() < 5e-3);
            assert!((made.alpha_rad - drawn.alpha_rad).abs() < 5e-3);
        }
        for joint in &first.joints {
            assert!(
                joint.error_rad(0.0).expect("an error").abs() < 1e-15,
                "home is exact"
            );
            assert!(joint.error_rad(0.5).expect("an error").abs() < 1e-2);
        }
    }
}
