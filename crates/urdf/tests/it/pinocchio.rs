//! Poses and Jacobians of the fixtures' tips against Pinocchio, which reads the URDFs itself.

use haptical_model::Evaluation;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Pose, Twist};
use haptical_urdf::{BaseAndTip, device_from_urdf};
use serde_json::Value;

use crate::support::{ROUNDING, fixture, gap};

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let numbers = value.as_array().unwrap();
    std::array::from_fn(|index| numbers[index].as_f64().unwrap())
}

#[test]
fn fixtures_agree_with_pinocchio() {
    let Some(text) = fixture("poses.json") else {
        return;
    };
    let document: Value = serde_json::from_str(&text).unwrap();
    let mut compared = 0;
    for robot in document["robots"].as_array().unwrap() {
        let file = robot["file"].as_str().unwrap();
        let read = device_from_urdf(&fixture(file).unwrap(), file, BaseAndTip::default()).unwrap();
        assert_eq!(read.tip, robot["tip"].as_str().unwrap());
        let mut evaluation = Evaluation::new(&read.device);
        for configuration in robot["configurations"].as_array().unwrap() {
            let joints = configuration["joints"].as_array().unwrap();
            let joints: Vec<f64> = joints.iter().map(|value| value.as_f64().unwrap()).collect();
            evaluation.move_to(&joints).unwrap();
            let rows: [Vector3<f64>; 3] = std::array::from_fn(|row| {
                Vector3::from(numbers(&configuration["rotation_rows"][row]))
            });
            let expected = Pose {
                position_m: Vector3::from(numbers(&configuration["position_m"])),
                rotation: Matrix3::from_rows(&rows.map(|row| row.transpose())),
            };
            let gap = gap(evaluation.pose().unwrap(), &expected);
            assert!(gap < ROUNDING, "{file} at {joints:?}: {gap:e}");
            let columns = configuration["jacobian_columns"].as_array().unwrap();
            assert_eq!(columns.len(), joints.len());
            for (joint, column) in columns.iter().enumerate() {
                let Twist { linear, angular } = evaluation.joint_twist(joint);
                let column: [f64; 6] = numbers(column);
                for axis in 0..3 {
                    assert!(
                        (linear[axis] - column[axis]).abs() < ROUNDING,
                        "{file} {joint}"
                    );
                    assert!(
                        (angular[axis] - column[axis + 3]).abs() < ROUNDING,
                        "{file} {joint}"
                    );
                }
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 10);
}
