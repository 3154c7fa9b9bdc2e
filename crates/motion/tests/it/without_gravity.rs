//! Torques from which gravity's part was taken off.

use haptical_model::{Recording, RigidBodies};
use haptical_motion::examine;

use super::arm::{Truth, device, recording};

/// The log as a controller writes it that takes gravity's part off.
fn compensated(log: &Recording) -> Recording {
    let bodies = RigidBodies::of_device(&device()).unwrap();
    let mut work = bodies.work();
    let joints = bodies.joint_count();
    let (mut at, still, mut torques) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
    let mut log = log.clone();
    for row in 0..log.len() {
        log.read_joints(row, &mut at);
        bodies
            .torques(&at, &still, &still, &mut work, &mut torques)
            .unwrap();
        for (column, torque) in log.torque_nm.iter_mut().zip(&torques) {
            column.as_mut().unwrap()[row] -= torque;
        }
    }
    log
}

#[test]
fn torques_without_gravitys_part_are_told_from_a_load_and_from_a_sound_arm() {
    let loaded = Truth {
        payload_kg: 1.0,
        ..Truth::default()
    };
    for truth in [Truth::default(), loaded] {
        let log = recording(truth, 1);
        let found = examine(&device(), &log, None, &[]).unwrap();
        assert!(!found.lacks_gravity);
    }
    let log = compensated(&recording(Truth::default(), 1));
    let found = examine(&device(), &log, None, &[]).unwrap();
    assert!(found.lacks_gravity && found.has_gap());
}
