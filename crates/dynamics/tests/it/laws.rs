//! Laws that hold in every tree, each between two functions that share little.

use haptical_dynamics::nalgebra::{Rotation3, Vector3};
use haptical_dynamics::{Inertia, Scratch, TorqueDerivatives, Wrench};
use proptest::prelude::*;

use crate::support::{Robot, State, gap, moving, vector};

/// Rounding of two ways to the same torque, relative to the largest.
const ROUNDING: f64 = 1e-11;
/// Central differences of the fourth order with steps of 1e-3: what is left of their truncation and rounding.
const DIFFERENCE: f64 = 1e-7;
const STEP: f64 = 1e-3;

/// The five-point derivative of the torques by one entry of a vector.
fn differences(robot: &Robot, state: &State, entry: impl Fn(&mut State) -> &mut f64) -> Vec<f64> {
    let at = |factor: f64| {
        let mut moved = state.clone();
        *entry(&mut moved) += factor * STEP;
        robot.inverse(&moved, &[])
    };
    let (near, far) = ([at(1.0), at(-1.0)], [at(2.0), at(-2.0)]);
    (0..state.q.len())
        .map(|joint| {
            let [near, far] = [&near, &far].map(|[after, before]| after[joint] - before[joint]);
            (8.0 * near - far) / (12.0 * STEP)
        })
        .collect()
}

fn column(matrix: &[f64], joint: usize, count: usize) -> Vec<f64> {
    (0..count).map(|row| matrix[row * count + joint]).collect()
}

/// A matrix, row by row, times a vector.
fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    let rows = matrix.chunks_exact(vector.len());
    rows.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
        .collect()
}

/// Whether all pivots of Gauss's elimination are positive: of a symmetric matrix, whether it is positive definite.
fn is_positive_definite(mut matrix: Vec<f64>, count: usize) -> bool {
    for pivot in 0..count {
        let size = matrix[pivot * count + pivot];
        if size.is_nan() || size <= 0.0 {
            return false;
        }
        for row in pivot + 1..count {
            let factor = matrix[row * count + pivot] / size;
            for column in pivot..count {
                matrix[row * count + column] -= factor * matrix[pivot * count + column];
            }
        }
    }
    true
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn torques_are_mass_times_acceleration_plus_bias((robot, state) in moving(9)) {
        let count = state.q.len();
        let mass = robot.mass(&state.q);
        let mut sum = times(&mass, &state.ddq);
        sum.iter_mut().zip(robot.bias(&state)).for_each(|(sum, bias)| *sum += bias);
        prop_assert!(gap(&robot.inverse(&state, &[]), &sum) < ROUNDING);
        for joint in 0..count {
            prop_assert_eq!(&mass[joint * count..][..count], &column(&mass, joint, count)[..]);
        }
        // about half of the joints have no armature: the links alone must do
        prop_assert!(is_positive_definite(mass, count));
    }

    #[test]
    fn the_regressor_times_the_parameters_is_the_torque((robot, state) in moving(9)) {
        let parameters = robot.bodies.iter().flat_map(|body| body.inertia.parameters());
        let parameters: Vec<f64> = parameters.collect();
        let mut torques = times(&robot.regressor(&state), &parameters);
        for (joint, body) in robot.bodies.iter().enumerate() {
            torques[joint] += body.armature_kgm2 * state.ddq[joint];
        }
        prop_assert!(gap(&torques, &robot.inverse(&state, &[])) < ROUNDING);
    }

    /// Of a body that a joint does not carry its row has nothing.
    #[test]
    fn the_regressor_is_as_sparse_as_the_tree((robot, state) in moving(9)) {
        let count = state.q.len();
        let regressor = robot.regressor(&state);
        for body in 0..count {
            let path = |own: &usize| robot.bodies[*own].parent;
            let carriers: Vec<usize> = core::iter::successors(Some(body), path).collect();
            for joint in (0..count).filter(|joint| !carriers.contains(joint)) {
                let start = 10 * (joint * count + body);
                prop_assert_eq!(&regressor[start..start + 10], &[0.0; 10]);
            }
        }
    }

    #[test]
    fn forward_dynamics_undoes_inverse_dynamics(
        (robot, state) in moving(9),
        body in any::<prop::sample::Index>(),
        [point_m, force_n, moment_nm] in [vector(0.4), vector(30.0), vector(5.0)],
    ) {
        let body = body.index(state.q.len());
        let wrenches = [Wrench { body, point_m, force_n, moment_nm }];
        let tau = robot.inverse(&state, &wrenches);
        let found = robot.forward(&state, &tau, &wrenches);
        // the condition of the mass matrix is up to 1e4
        prop_assert!(gap(&found, &state.ddq) < 1e-9);
    }

    #[test]
    fn derivatives_are_those_of_central_differences((robot, state) in moving(7)) {
        let count = state.q.len();
        let [by_q, by_dq] = robot.derivatives(&state);
        let mass = robot.mass(&state.q);
        for joint in 0..count {
            let found = differences(&robot, &state, |own| &mut own.q[joint]);
            prop_assert!(gap(&column(&by_q, joint, count), &found) < DIFFERENCE, "by q {}", joint);
            let found = differences(&robot, &state, |own| &mut own.dq[joint]);
            prop_assert!(gap(&column(&by_dq, joint, count), &found) < DIFFERENCE, "by dq {}", joint);
            let found = differences(&robot, &state, |own| &mut own.ddq[joint]);
            prop_assert!(gap(&column(&mass, joint, count), &found) < DIFFERENCE, "by ddq {}", joint);
        }
    }

    /// Virtual power: a wrench takes from the torques what its point's motion gives to it.
    #[test]
    fn a_wrench_does_the_work_that_the_joints_are_spared(
        (robot, state) in moving(9),
        body in any::<prop::sample::Index>(),
        [point_m, force_n] in [vector(0.4), vector(30.0)],
    ) {
        let body = body.index(state.q.len());
        let wrench = Wrench { body, point_m, force_n, moment_nm: Vector3::zeros() };
        let free = robot.inverse(&state, &[]);
        let helped = robot.inverse(&state, &[wrench]);
        let power: f64 = (0..free.len()).map(|j| (free[j] - helped[j]) * state.dq[j]).sum();
        let place = |time: f64| {
            let q: Vec<f64> = state.q.iter().zip(&state.dq).map(|(q, dq)| q + time * dq).collect();
            let mut scratch = vec![Scratch::default(); q.len()];
            robot.tree().potential_energy_j(&q, &mut scratch).unwrap();
            let pose = scratch[body].pose();
            pose.position_m + pose.rotation * point_m
        };
        let (h, near) = (1e-3, place(1e-3) - place(-1e-3));
        let velocity = (near * 8.0 - (place(2.0 * h) - place(-2.0 * h))) / (12.0 * h);
        let expected = force_n.dot(&velocity);
        prop_assert!((power - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{power} {expected}");
    }

    /// Where the base's origin is, and how its axes lie, does not matter; rounding grows with the distance alone.
    #[test]
    fn a_tree_moves_alike_wherever_it_stands(
        (robot, state) in moving(7),
        [place, turn] in [vector(5.0), vector(3.0)],
    ) {
        let rotation = *Rotation3::new(turn).matrix();
        let mut moved = robot.clone();
        moved.gravity_mps2 = rotation * robot.gravity_mps2;
        for body in moved.bodies.iter_mut().filter(|body| body.parent.is_none()) {
            body.placement.position_m = place + rotation * body.placement.position_m;
            body.placement.rotation = rotation * body.placement.rotation;
        }
        let alike = |left: &[f64], right: &[f64]| gap(left, right) < ROUNDING;
        prop_assert!(alike(&moved.inverse(&state, &[]), &robot.inverse(&state, &[])));
        prop_assert!(alike(&moved.mass(&state.q), &robot.mass(&state.q)));
        prop_assert!(alike(&moved.regressor(&state), &robot.regressor(&state)));
        let (moved, own) = (moved.derivatives(&state), robot.derivatives(&state));
        prop_assert!(alike(&moved[0], &own[0]) && alike(&moved[1], &own[1]));
    }

    /// Gravity's torques are the slope of the potential energy.
    #[test]
    fn weight_is_the_slope_of_the_potential_energy((robot, state) in moving(7)) {
        let rest = State { dq: vec![0.0; state.q.len()], ..state };
        let bias = robot.bias(&rest);
        for joint in 0..rest.q.len() {
            let at = |factor: f64| {
                let mut q = rest.q.clone();
                q[joint] += factor * STEP;
                robot.energies(&q, &rest.dq)[1]
            };
            let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * STEP);
            prop_assert!((bias[joint] - slope).abs() < 1e-8 * (1.0 + slope.abs()));
        }
    }
}

#[test]
fn a_call_allocates_nothing() {
    let body = |parent| haptical_dynamics::Body {
        parent,
        placement: haptical_dynamics::Pose {
            position_m: Vector3::new(0.3, 0.0, 0.1),
            ..Default::default()
        },
        joint: haptical_dynamics::Joint::Revolute(Vector3::y_axis()),
        inertia: Inertia::from_parameters([1.0, 0.1, 0.0, 0.2, 0.2, 0.3, 0.2, 0.0, 0.0, 0.0]),
        armature_kgm2: 0.01,
    };
    let bodies = [body(None), body(Some(0)), body(Some(0))];
    let (mut scratch, mut out) = ([Scratch::default(); 3], [0.0; 3]);
    let (mut by_q, mut by_dq, mut regressor) = ([0.0; 9], [0.0; 9], [0.0; 90]);
    let counted = allocation_counter::measure(|| {
        let tree = haptical_dynamics::Tree::new(&bodies, Vector3::z() * -9.81).unwrap();
        for first in [0.4, f64::NAN] {
            let (q, dq, ddq) = ([first, 0.1, -0.2], [1.0, -2.0, 0.3], [0.1, 0.2, 0.3]);
            let _ = tree.inverse_dynamics(&q, &dq, &ddq, &[], &mut scratch, &mut out);
            let _ = tree.forward_dynamics(&q, &dq, &ddq, &[], &mut scratch, &mut out);
            let _ = tree.mass_matrix(&q, &mut scratch, &mut by_q);
            let _ = tree.regressor(&q, &dq, &ddq, &mut scratch, &mut regressor);
            let derivatives = TorqueDerivatives {
                by_q: &mut by_q,
                by_dq: &mut by_dq,
            };
            let _ = tree.torque_derivatives(&q, &dq, &ddq, &mut scratch, derivatives);
            let _ = tree.kinetic_energy_j(&q, &dq, &mut scratch);
            assert!(bodies[0].inertia.is_physical());
        }
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
