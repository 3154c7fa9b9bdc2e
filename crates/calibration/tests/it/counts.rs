//! The structural counts of docs/equations.md, "Structural count of identifiable parameters".

use haptical_identification::{Matrix, Reduction};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Convention, Link};
use haptical_model::{Device, Evaluation, JointType};
use proptest::prelude::*;

use crate::chain::{
    ROWS, Rig, cable_at, columns, combination, generic_chain, measure, measure_at, pruned,
    structure, turned_when_locked,
};
use crate::haptic;

/// Coefficients come from a triangular system with a condition number of up to 1e6.
const COEFFICIENT_TOLERANCE: f64 = 1e-6;

/// Parameters that a rig fixes of a generic chain.
fn structural_count(rig: Rig, joints: usize) -> usize {
    match rig {
        Rig::Cable => 4 * joints,
        Rig::Position => 4 * joints + 3,
        Rig::Pose => 4 * joints + 4,
    }
}

fn rank(device: &Device, rig: Rig, seed: u64) -> usize {
    let judged = structure(device, &measure(device, rig, ROWS, seed));
    assert!(
        judged.is_clear(),
        "{} by singular values",
        judged.singular_rank
    );
    judged.rank
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn generic_chains_have_the_structural_count(device in generic_chain(2..=7), seed: u64) {
        let n = device.joints.len();
        for rig in crate::chain::RIGS {
            let judged = structure(&device, &measure(&device, rig, ROWS, seed));
            prop_assert!(judged.is_clear());
            prop_assert_eq!(judged.rank, structural_count(rig, n), "{:?}", rig);
            let last_twist = format!("alpha{n}");
            let (invisible, dependent) = pruned(&judged);
            match rig {
                Rig::Cable => {
                    prop_assert_eq!(invisible, vec!["theta0", &last_twist]);
                    let mut dependent = dependent;
                    dependent.sort_unstable();
                    prop_assert_eq!(dependent, vec!["alpha0", "d0"]);
                }
                Rig::Position => prop_assert_eq!((invisible, dependent), (vec![last_twist.as_str()], vec![])),
                Rig::Pose => prop_assert_eq!((invisible, dependent), (vec![], vec![])),
            }
        }
    }

    /// The three column identities, solved for the two parameters that the order leaves out.
    #[test]
    fn a_turn_about_the_anchor_is_named_with_its_coefficients(
        device in generic_chain(2..=6), seed: u64,
    ) {
        let judged = structure(&device, &measure(&device, Rig::Cable, ROWS, seed));
        let Link { a_m: a, d_m: d, alpha_rad, .. } = device.links[0];
        let (s, c) = (alpha_rad.sin(), alpha_rad.cos());
        let expected = [
            ("d0", [("theta1", -s / a), ("a0", d * s * s / a), ("d1", c)]),
            ("alpha0", [("theta1", -d * c / a), ("a0", d * d * s * c / a), ("d1", -d * s)]),
        ];
        for (name, terms) in expected {
            let found = combination(&judged, name);
            prop_assert_eq!(found.len(), 3, "{} = {:?}", name, &found);
            for ((kept, coefficient), (expected, value)) in found.into_iter().zip(terms) {
                prop_assert_eq!(kept, expected);
                let size = value.abs().max(1.0);
                prop_assert!((coefficient - value).abs() < COEFFICIENT_TOLERANCE * size,
                    "{}: {} {} instead of {}", name, kept, coefficient, value);
            }
        }
    }

    /// Twelve more columns, a turn and a slide of frame (-1) and of the handle along each axis, add
    /// two to the pose's count: the rest of both are numbers of the table already.
    #[test]
    fn a_general_base_and_tool_add_two(device in generic_chain(2..=6), seed: u64) {
        let recording = measure(&device, Rig::Pose, ROWS, seed);
        let found = columns(&device, &recording);
        let own = found.jacobian.columns();
        let mut evaluation = Evaluation::new(&device);
        let mut jacobian = Matrix::from_fn(6 * ROWS, own + 12, |row, column| {
            if column < own { found.jacobian[(row, column)] } else { 0.0 }
        });
        for row in 0..ROWS {
            let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
            evaluation.move_to(&readings).unwrap();
            let pose = evaluation.pose().unwrap();
            for axis in 0..3 {
                let (base, tool) = (Vector3::ith(axis, 1.0), pose.rotation.column(axis).into_owned());
                let twists = [
                    (base.cross(&pose.position_m), base),
                    (base, Vector3::zeros()),
                    (Vector3::zeros(), tool),
                    (tool, Vector3::zeros()),
                ];
                for (kind, (linear, angular)) in twists.into_iter().enumerate() {
                    let column = jacobian.column_mut(own + 4 * axis + kind);
                    column[3 * row..3 * row + 3].copy_from_slice((linear * 1e4).as_slice());
                    let row = ROWS + row;
                    column[3 * row..3 * row + 3].copy_from_slice((angular * 1e4).as_slice());
                }
            }
        }
        let reduction = Reduction::new(&jacobian, &vec![0.0; 6 * ROWS]).unwrap();
        let all: Vec<usize> = (0..own + 12).collect();
        let rank = reduction.ordered_rank(&all, 1e-9).unwrap().independent.len();
        prop_assert_eq!(rank, 4 * device.joints.len() + 6);
    }

    #[test]
    fn a_prismatic_joint_counts_two(device in generic_chain(3..=6), at in 0.0..1.0_f64, seed: u64) {
        let n = device.joints.len();
        let joint = (at * n as f64) as usize;
        let mut device = device;
        device.joints[joint].joint_type = JointType::Prismatic;
        for rig in crate::chain::RIGS {
            let last = usize::from(rig == Rig::Pose && joint + 1 == n);
            prop_assert_eq!(rank(&device, rig, seed), structural_count(rig, n) - 2 + last,
                "joint {} of {}, {:?}", joint + 1, n, rig);
        }
    }

    #[test]
    fn a_handle_on_the_last_axis_costs_three(device in generic_chain(2..=6), seed: u64) {
        let n = device.joints.len();
        let mut device = device;
        device.links[n].a_m = 0.0;
        for rig in [Rig::Cable, Rig::Position] {
            // Of two joints only the first moves the handle then: one more for a distance.
            let flat = usize::from(n == 2 && rig == Rig::Cable);
            let judged = structure(&device, &measure(&device, rig, ROWS, seed));
            prop_assert_eq!(judged.rank, structural_count(rig, n) - 3 - flat);
            let theta = format!("theta{n}");
            prop_assert!(pruned(&judged).0.contains(&theta.as_str()));
        }
    }

    #[test]
    fn an_anchor_on_the_first_axis_costs_two(device in generic_chain(2..=6), seed: u64) {
        let mut device = device;
        (device.links[0].a_m, device.links[0].d_m) = (0.0, 0.0);
        let n = device.joints.len();
        // Of two joints only the second changes a distance then: one more.
        let flat = usize::from(n == 2);
        prop_assert_eq!(rank(&device, Rig::Cable, seed), 4 * n - 2 - flat);
    }

    #[test]
    fn a_locked_joint_costs_four(device in generic_chain(3..=6), at in 0.0..1.0_f64, seed: u64) {
        let n = device.joints.len();
        let joint = (at * n as f64) as usize;
        prop_assume!(turned_when_locked(&device, joint, 0.3));
        for rig in crate::chain::RIGS {
            let mut readings = measure(&device, rig, ROWS, seed).joint;
            readings[joint] = vec![0.3; ROWS];
            let judged = structure(&device, &measure_at(&device, rig, readings));
            let tool = if rig == Rig::Pose && joint + 1 == n { 2 } else { 0 };
            prop_assert_eq!(judged.rank, structural_count(rig, n) - 4 + tool,
                "joint {} of {}, {:?}", joint + 1, n, rig);
        }
    }

    #[test]
    fn the_modified_convention_ends_on_the_last_axis(device in generic_chain(3..=6), seed: u64) {
        let mut device = device;
        device.convention = Convention::Modified;
        let n = device.joints.len();
        for (rig, count) in [(Rig::Pose, 4 * n + 2), (Rig::Position, 4 * n - 1), (Rig::Cable, 4 * n - 4)] {
            prop_assert_eq!(rank(&device, rig, seed), count, "{:?}", rig);
        }
    }

    /// Distances to two points leave the turn about their line, which a third point on it keeps.
    #[test]
    fn cables_on_one_line_leave_a_turn(device in generic_chain(2..=5), share in 0.2..0.8_f64, seed: u64) {
        let mut device = device;
        let n = device.joints.len();
        let far = [0.31, -0.22, 0.17];
        device.cables.push(cable_at(far));
        prop_assert_eq!(rank(&device, Rig::Cable, seed), 4 * n + 2);
        device.cables.push(cable_at(far.map(|x| share * x)));
        prop_assert_eq!(rank(&device, Rig::Cable, seed), 4 * n + 2);
        device.cables[2] = cable_at([-0.2, 0.1, 0.4]);
        prop_assert_eq!(rank(&device, Rig::Cable, seed), 4 * n + 3);
    }
}

#[test]
fn the_haptic_device_has_twenty_eight() {
    let Some(device) = haptic::haptic7() else {
        return;
    };
    let device = haptic::exact_readings(device);
    let judged = structure(&device, &measure(&device, Rig::Cable, 300, 1));
    assert_eq!((judged.rank, judged.singular_rank), (28, 28));
    assert_eq!(
        pruned(&judged),
        (vec!["alpha0", "theta0", "alpha7"], vec!["d0"])
    );
    let found = combination(&judged, "d0");
    assert_eq!((found.len(), found[0].0), (1, "theta1"));
    assert!((found[0].1 - 1.0 / device.links[0].a_m).abs() < COEFFICIENT_TOLERANCE);

    let with_tracker = Device {
        tracker: crate::chain::device_of(device.links.clone()).tracker,
        ..device.clone()
    };
    assert_eq!(rank(&with_tracker, Rig::Position, 1), 31);
    assert_eq!(rank(&with_tracker, Rig::Pose, 1), 32);

    let mut on_axis = device.clone();
    on_axis.links[7].a_m = 0.0;
    assert_eq!(rank(&on_axis, Rig::Cable, 1), 25);

    let mut readings = measure(&device, Rig::Cable, 300, 1).joint;
    readings[2] = vec![0.0; 300];
    assert_eq!(
        structure(&device, &measure_at(&device, Rig::Cable, readings)).rank,
        24
    );
}
