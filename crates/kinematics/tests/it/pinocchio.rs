//! Compares with poses, Jacobians and parameter derivatives computed by Pinocchio.

use std::path::Path;

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Convention, Link, Motion, Parameter, Pose, Twist};
use serde_json::Value;

use crate::prepared::prepared;
use crate::support::{Case, pose_gap, twist_gap};

/// Both sides round about 50 elementary motions with lengths of order 1 m: 1e-14; the rest is room
/// for another version of either library.
const PINOCCHIO: f64 = 1e-12;

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list = value.as_array().unwrap();
    assert_eq!(list.len(), N);
    core::array::from_fn(|index| list[index].as_f64().unwrap())
}

fn twist(value: &Value) -> Twist {
    let [vx, vy, vz, wx, wy, wz] = numbers(value);
    Twist {
        linear: Vector3::new(vx, vy, vz),
        angular: Vector3::new(wx, wy, wz),
    }
}

fn link(value: &Value) -> Link {
    let mut link = Link::default();
    for parameter in Parameter::ALL {
        // the file's chains have no slide along y
        let number = &value[parameter.name()];
        if !(parameter == Parameter::B && number.is_null()) {
            link.set(parameter, number.as_f64().unwrap());
        }
    }
    link
}

fn motion(value: &Value) -> Motion {
    match value.as_str().unwrap() {
        "fixed" => Motion::Fixed,
        "revolute" => Motion::Revolute,
        "prismatic" => Motion::Prismatic,
        other => panic!("unknown motion {other}"),
    }
}

fn convention(value: &Value) -> Convention {
    match value.as_str().unwrap() {
        "standard" => Convention::Standard,
        "modified" => Convention::Modified,
        other => panic!("unknown convention {other}"),
    }
}

fn compare(case: &Case, expected: &Value) {
    let rows = expected["rotation_rows"].as_array().unwrap();
    let rows: Vec<_> = rows
        .iter()
        .map(|row| Vector3::from(numbers(row)).transpose())
        .collect();
    let pose = Pose {
        position_m: Vector3::from(numbers(&expected["position_m"])),
        rotation: Matrix3::from_rows(&rows),
    };
    assert!(pose_gap(&case.pose(), &pose) < PINOCCHIO, "{case:?}");

    let columns = expected["jacobian_columns"].as_array().unwrap();
    let jacobian = case.jacobian();
    assert_eq!(jacobian.len(), columns.len());
    for (joint, (column, value)) in jacobian.iter().zip(columns).enumerate() {
        assert!(
            twist_gap(column, &twist(value)) < PINOCCHIO,
            "joint {joint} of {case:?}"
        );
    }

    let (prepared_pose, prepared_jacobian) = prepared(case).unwrap();
    assert!(pose_gap(&prepared_pose, &pose) < PINOCCHIO, "{case:?}");
    for (column, value) in prepared_jacobian.iter().zip(columns) {
        assert!(twist_gap(column, &twist(value)) < PINOCCHIO, "{case:?}");
    }

    let rows = expected["derivatives"].as_array().unwrap();
    let derivatives = case.derivatives();
    assert_eq!(derivatives.len(), rows.len());
    for (row, (link, value)) in derivatives.iter().zip(rows).enumerate() {
        for parameter in Parameter::ALL.into_iter().filter(|p| *p != Parameter::B) {
            let gap = twist_gap(&link.get(parameter), &twist(&value[parameter.name()]));
            assert!(gap < PINOCCHIO, "row {row} {parameter} of {case:?}");
        }
    }
}

#[test]
fn chains_agree_with_pinocchio() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/pinocchio/chains.json");
    if !path.exists() {
        println!(
            "skipped: {} is absent, as in a packaged crate",
            path.display()
        );
        return;
    }
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut compared = 0;
    for chain in file["chains"].as_array().unwrap() {
        for configuration in chain["configurations"].as_array().unwrap() {
            let joints = configuration["joints"].as_array().unwrap();
            let case = Case {
                convention: convention(&chain["convention"]),
                links: chain["links"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(link)
                    .collect(),
                motions: chain["motions"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(motion)
                    .collect(),
                joints: joints.iter().map(|joint| joint.as_f64().unwrap()).collect(),
                origins: Vec::new(),
            };
            compare(&case, configuration);
            compared += 1;
        }
    }
    assert_eq!(
        compared,
        24 * 3,
        "the file does not hold the chains its README names"
    );
}
