//! Compares with the dynamics of random trees computed by Pinocchio and by MuJoCo.

use std::path::Path;

use haptical_dynamics::nalgebra::{Matrix3, Unit, Vector3};
use haptical_dynamics::{Body, Inertia, Joint, Pose, Wrench};
use serde_json::Value;

use crate::support::{Robot, State, gap};

/// Relative to the largest entry. Rounding is 5e-14 at most, in the accelerations of the trees with light bodies on long
/// branches; the rest is room for another version of either program.
const PEERS: f64 = 1e-12;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn body(value: &Value) -> Body {
    let axis = Unit::new_normalize(vector(&value["axis"]));
    let inertia = Matrix3::from_row_slice(&numbers(&value["inertia_kgm2"]));
    let centre_m = vector(&value["centre_of_mass_m"]);
    Body {
        parent: usize::try_from(value["parent"].as_i64().unwrap()).ok(),
        placement: Pose {
            position_m: vector(&value["position_m"]),
            rotation: Matrix3::from_row_slice(&numbers(&value["rotation"])),
        },
        joint: match value["joint"].as_str().unwrap() {
            "revolute" => Joint::Revolute(axis),
            "prismatic" => Joint::Prismatic(axis),
            other => panic!("unknown joint {other}"),
        },
        inertia: Inertia::about_centre(number(&value["mass_kg"]), &centre_m, &inertia),
        armature_kgm2: number(&value["armature_kgm2"]),
    }
}

/// The regressor of the file, which has only the blocks that are not 0.
fn regressor(value: &Value, count: usize) -> Vec<f64> {
    let mut whole = vec![0.0; 10 * count * count];
    for block in value.as_array().unwrap() {
        let place = |key: &str| usize::try_from(block[key].as_u64().unwrap()).unwrap();
        let start = 10 * (place("joint") * count + place("body"));
        whole[start..start + 10].copy_from_slice(&numbers(&block["entries"]));
    }
    whole
}

fn compare(what: &str, own: &[f64], peer: &Value) {
    let gap = gap(own, &numbers(peer));
    assert!(gap < PEERS, "{what}: {gap:e}");
}

#[test]
fn trees_move_as_in_pinocchio_and_mujoco() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/dynamics/trees.json");
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let trees = file["trees"].as_array().unwrap();
    assert_eq!(trees.len(), 18);
    let mut branches = 0;
    for tree in trees {
        let robot = Robot {
            bodies: tree["bodies"]
                .as_array()
                .unwrap()
                .iter()
                .map(body)
                .collect(),
            gravity_mps2: vector(&file["gravity_mps2"]),
        };
        let serial = |(index, body): (usize, &Body)| body.parent == index.checked_sub(1);
        branches += usize::from(!robot.bodies.iter().enumerate().all(serial));
        let state = |key: &str| numbers(&tree["state"][key]);
        let tau = state("tau");
        let state = State {
            q: state("q"),
            dq: state("dq"),
            ddq: state("ddq"),
        };
        let wrench = &tree["wrench"];
        let wrench = [Wrench {
            body: usize::try_from(wrench["body"].as_u64().unwrap()).unwrap(),
            point_m: vector(&wrench["point_m"]),
            force_n: vector(&wrench["force_n"]),
            moment_nm: vector(&wrench["moment_nm"]),
        }];
        let [kinetic, potential] = robot.energies(&state.q, &state.dq);
        let answers = [
            ("inverse_dynamics", robot.inverse(&state, &[])),
            ("with_wrench", robot.inverse(&state, &wrench)),
            ("bias", robot.bias(&state)),
            ("mass_matrix", robot.mass(&state.q)),
            ("forward_dynamics", robot.forward(&state, &tau, &[])),
            ("forward_with_wrench", robot.forward(&state, &tau, &wrench)),
            ("kinetic_energy_j", vec![kinetic]),
            ("potential_energy_j", vec![potential]),
        ];
        for peer in ["pinocchio", "mujoco"] {
            for (what, own) in &answers {
                compare(&format!("{what} by {peer}"), own, &tree[peer][*what]);
            }
        }
        let peer = &tree["pinocchio"];
        let [by_q, by_dq] = robot.derivatives(&state);
        compare("by_q", &by_q, &peer["by_q"]);
        compare("by_dq", &by_dq, &peer["by_dq"]);
        let own = robot.regressor(&state);
        let gap = gap(&own, &regressor(&peer["regressor"], robot.bodies.len()));
        assert!(gap < PEERS, "regressor: {gap:e}");
    }
    assert_eq!(branches, 7);
}
