//! Bodies against numbers of Pinocchio and MuJoCo, and against a device file.

use std::path::Path;

use haptical_model::kinematics::nalgebra::{Matrix3, Rotation3, Vector3};
use haptical_model::{Device, Evaluation};
use serde_json::Value;

use crate::moving::arms::{Arm, SEVEN, SIX, SLIDER, device_toml};
use crate::moving::motion::rigid::{At, Chain, Link, solve};
use crate::random::Random;

/// Relative to the largest entry: sums of some hundred products.
const ROUNDING: f64 = 1e-11;

fn numbers(value: &Value) -> Vec<f64> {
    let entries = value.as_array().unwrap().iter();
    entries
        .flat_map(|entry| {
            entry
                .as_f64()
                .map_or_else(|| numbers(entry), |own| vec![own])
        })
        .collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_vec(numbers(value))
}

fn matrix(value: &Value) -> Matrix3<f64> {
    Matrix3::from_row_slice(&numbers(value))
}

/// A tree without branches as a chain whose joints are along z: each body's frame is turned so that its axis is.
fn chain(tree: &Value, gravity_mps2: Vector3<f64>) -> Chain {
    let mut back = Matrix3::identity();
    let mut links = Vec::new();
    for body in tree["bodies"].as_array().unwrap() {
        let axis = vector(&body["axis"]);
        let to_axis = *Rotation3::rotation_between(&Vector3::z(), &axis)
            .unwrap()
            .matrix();
        links.push(Link {
            slides: body["joint"] == "prismatic",
            origin_m: back * vector(&body["position_m"]),
            turn: back * matrix(&body["rotation"]) * to_axis,
            mass_kg: body["mass_kg"].as_f64().unwrap(),
            centre_m: to_axis.transpose() * vector(&body["centre_of_mass_m"]),
            inertia_kgm2: to_axis.transpose() * matrix(&body["inertia_kgm2"]) * to_axis,
        });
        back = to_axis.transpose();
    }
    Chain {
        links,
        gravity_mps2,
        flange_m: Vector3::zeros(),
        behind: 0,
    }
}

fn assert_close(found: &[f64], expected: &[f64]) {
    let largest = expected
        .iter()
        .fold(1.0_f64, |most, own| most.max(own.abs()));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() < ROUNDING * largest,
            "{found} {expected}"
        );
    }
}

/// Mass matrices and bias forces of the ten chains among the fixture's trees, that slide and turn about any axis.
#[test]
fn bodies_agree_with_pinocchio_and_mujoco() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dynamics/trees.json");
    let fixture: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let gravity = vector(&fixture["gravity_mps2"]);
    let mut seen = 0;
    for tree in fixture["trees"].as_array().unwrap() {
        let bodies = tree["bodies"].as_array().unwrap();
        let is_chain = (-1..)
            .zip(bodies)
            .all(|(before, body)| body["parent"] == before);
        if !is_chain {
            continue;
        }
        let chain = chain(tree, gravity);
        let (q, dq) = (numbers(&tree["state"]["q"]), numbers(&tree["state"]["dq"]));
        let mut at = At::default();
        chain.at(&q, &dq, &mut at);
        for (joint, body) in bodies.iter().enumerate() {
            at.mass[joint * bodies.len() + joint] += body["armature_kgm2"].as_f64().unwrap();
        }
        for program in ["pinocchio", "mujoco"] {
            assert_close(&at.mass, &numbers(&tree[program]["mass_matrix"]));
            assert_close(&at.bias, &numbers(&tree[program]["bias"]));
        }
        let tau = numbers(&tree["state"]["tau"]);
        let mut found: Vec<f64> = tau
            .iter()
            .zip(&at.bias)
            .map(|(tau, bias)| tau - bias)
            .collect();
        solve(&mut at.mass, &mut found);
        assert_close(&found, &numbers(&tree["pinocchio"]["forward_dynamics"]));
        seen += 1;
    }
    assert!(seen >= 10, "{seen} chains");
}

/// The flange is where the device file's handle is, its velocity the slope of its place, and a force on it does the work that
/// it does on the joints.
#[test]
fn the_file_describes_the_arm() {
    let mut random = Random::new(5, 0);
    let arms: [&Arm; 3] = [&SIX, &SEVEN, &SLIDER];
    for arm in arms {
        let device = Device::from_toml(&device_toml(arm, true), arm.name)
            .unwrap()
            .device;
        let mut evaluation = Evaluation::new(&device);
        let chain = arm.chain();
        let (mut at, mut later) = (At::default(), At::default());
        for _ in 0..10 {
            let mut draw = |size: f64| -> Vec<f64> {
                arm.axes
                    .iter()
                    .map(|axis| size * random.uniform(axis.reach[0], axis.reach[1]))
                    .collect()
            };
            let (q, dq) = (draw(0.9), draw(1.0));
            evaluation.move_to(&q).unwrap();
            chain.at(&q, &dq, &mut at);
            let (place_m, velocity) = at.flange();
            assert!(
                (place_m - evaluation.pose().unwrap().position_m).norm() < 1e-12,
                "{}",
                arm.name
            );
            let step = 1e-6;
            let ahead: Vec<f64> = q.iter().zip(&dq).map(|(q, dq)| q + step * dq).collect();
            chain.at(&ahead, &dq, &mut later);
            assert!(((later.flange().0 - place_m) / step - velocity).norm() < 1e-4);
            let force = Vector3::new(3.0, -2.0, 5.0);
            let mut torque = vec![0.0; arm.count()];
            at.add_at_flange(&force, &mut torque);
            let power: f64 = torque.iter().zip(&dq).map(|(torque, dq)| torque * dq).sum();
            assert!((power - force.dot(&velocity)).abs() < 1e-10);
        }
        for (axis, body) in arm.axes.iter().zip(&device.bodies[1..]) {
            let body = body.unwrap();
            assert_eq!(
                (body.mass_kg, body.centre_of_mass_m),
                (axis.mass_kg, axis.centre_m)
            );
            assert_eq!(body.inertia_kgm2.unwrap()[..3], axis.inertia_kgm2);
        }
        for (axis, joint) in arm.axes.iter().zip(&device.joints) {
            let stated = (joint.armature_kgm2, joint.torque_limit_nm);
            assert_eq!(stated, (Some(axis.armature), Some(axis.range)));
        }
    }
}

/// Moments of inertia of a body obey the triangle inequality: no two make less than the third.
#[test]
fn bodies_are_possible() {
    let arms: [&Arm; 3] = [&SIX, &SEVEN, &SLIDER];
    for axis in arms.iter().flat_map(|arm| arm.axes) {
        let [x, y, z] = axis.inertia_kgm2;
        assert!(x + y > z && y + z > x && z + x > y, "{axis:?}");
    }
}
