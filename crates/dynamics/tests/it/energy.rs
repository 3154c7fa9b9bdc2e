//! Without friction the energy of a motion stays what it was.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::support::{Robot, State, moving};

const STEP_S: f64 = 2.5e-4;
const STEPS: usize = 40_000;

/// Velocities and accelerations of a motion without torques.
fn slope(robot: &Robot, q: &[f64], dq: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let state = State {
        q: q.to_vec(),
        dq: dq.to_vec(),
        ddq: Vec::new(),
    };
    (dq.to_vec(), robot.forward(&state, &vec![0.0; q.len()], &[]))
}

fn along(start: &[f64], step: f64, slope: &[f64]) -> Vec<f64> {
    start.iter().zip(slope).map(|(x, k)| x + step * k).collect()
}

/// A step of the classical Runge-Kutta method of order four.
fn step(robot: &Robot, q: &mut [f64], dq: &mut [f64]) {
    let h = STEP_S;
    let (v1, a1) = slope(robot, q, dq);
    let (v2, a2) = slope(robot, &along(q, h / 2.0, &v1), &along(dq, h / 2.0, &a1));
    let (v3, a3) = slope(robot, &along(q, h / 2.0, &v2), &along(dq, h / 2.0, &a2));
    let (v4, a4) = slope(robot, &along(q, h, &v3), &along(dq, h, &a3));
    for joint in 0..q.len() {
        q[joint] += h / 6.0 * (v1[joint] + 2.0 * v2[joint] + 2.0 * v3[joint] + v4[joint]);
        dq[joint] += h / 6.0 * (a1[joint] + 2.0 * a2[joint] + 2.0 * a3[joint] + a4[joint]);
    }
}

/// Ten seconds of three trees that fall, swing and whirl. Kinetic energy alone changes by more than a half
/// meanwhile: what one form loses the other has.
#[test]
fn energy_is_kept_for_ten_seconds() {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    // hinges alone: a slide without an end falls for ten seconds, and energy has no scale then
    let hinges = moving(4).prop_filter("hinges", |(robot, state)| {
        let turns = |body: &haptical_dynamics::Body| {
            matches!(body.joint, haptical_dynamics::Joint::Revolute(_))
        };
        state.q.len() > 1 && robot.bodies.iter().all(turns)
    });
    for _ in 0..3 {
        let (robot, state) = hinges.new_tree(&mut runner).unwrap().current();
        let State { mut q, mut dq, .. } = state;
        let [kinetic, potential] = robot.energies(&q, &dq);
        let (start, mut exchanged, mut worst) = (kinetic + potential, 0.0_f64, 0.0_f64);
        let mut largest = kinetic;
        for count in 0..STEPS {
            step(&robot, &mut q, &mut dq);
            if count % 100 == 99 {
                let [now, height] = robot.energies(&q, &dq);
                worst = worst.max((now + height - start).abs());
                exchanged = exchanged.max((now - kinetic).abs());
                largest = largest.max(now);
            }
        }
        assert!(worst < 1e-9 * largest, "{:e}", worst / largest);
        assert!(exchanged > 0.5 * kinetic, "{exchanged} {kinetic}");
    }
}
