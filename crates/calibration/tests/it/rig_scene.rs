//! Simulated rigs: devices with cables, tracker, sockets, planes and fixtures, and what these measure.

use std::path::Path;

use haptical_model::kinematics::nalgebra::{Rotation3, UnitQuaternion, Vector3};
use haptical_model::kinematics::{Link, Pose};
use haptical_model::{
    CableFit, ContactPair, ContactPoint, Device, Evaluation, JointCompliance, Origin, Placement,
    PlanePair, Recording, TouchedPlane, Tracker,
};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::chain::{cable_at, device_of, pseudo_random};

/// A seven-joint arm with general rows.
pub(crate) fn general() -> Device {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    Device::load(&fixtures.join("panda.toml")).unwrap().device
}

/// A Denavit-Hartenberg arm without special values.
pub(crate) fn table(joints: usize) -> Device {
    let link = |row: usize| {
        let number = |index: u64| pseudo_random(77, 10 * row as u64 + index);
        Link {
            a_m: 0.2 + 0.1 * number(0),
            alpha_rad: 0.9 + 0.4 * number(1),
            d_m: 0.15 + 0.1 * number(2),
            theta_rad: 1.5 * number(3),
            beta_rad: 0.0,
            b_m: 0.0,
        }
    };
    device_of((0..=joints).map(link).collect())
}

/// Standard normal numbers that only depend on seed and index.
pub(crate) fn normal(seed: u64, index: u64) -> f64 {
    let uniform = 0.5 + 0.5 * pseudo_random(seed, index);
    let standard = Normal::new(0.0, 1.0).unwrap();
    standard.inverse_cdf(uniform.clamp(1e-12, 1.0 - 1e-12))
}

pub(crate) fn unknown_tracker(device: &mut Device) {
    device.tracker = Some(Tracker {
        base_known: false,
        base_per_run: false,
        tool_known: false,
        position_sd_m: Some(1e-4),
        rotation_sd_rad: Some(2e-4),
        scale_sd: Some(0.0),
    });
}

/// A placement far from the identity, with a turn from its start where `turn` is not zero.
pub(crate) fn placement(seed: u64, reach_m: f64, turn: f64) -> Placement {
    let number = |index: u64| pseudo_random(seed, index);
    let axis = Vector3::new(number(0), number(1), number(2)) * 2.0;
    Placement {
        start: Origin::from_pose(&Pose {
            position_m: Vector3::new(number(3), number(4), number(5)) * reach_m,
            rotation: Rotation3::new(axis).into_inner(),
        }),
        turn_rad: [turn * number(6), turn * number(7), turn * number(8)],
    }
}

/// Everything that a device file can say besides the chain.
pub(crate) fn with_everything(mut device: Device) -> Device {
    unknown_tracker(&mut device);
    device.surroundings.tracker_base = Some(placement(1, 1.0, 0.4));
    device.surroundings.tracker_tool = Some(placement(2, 0.1, 0.4));
    let point = |id: &str, seed: u64| ContactPoint {
        id: id.to_owned(),
        position_m: [0, 1, 2].map(|axis| 0.5 * pseudo_random(seed, axis)),
    };
    device.surroundings.contacts = vec![point("left", 3), point("right", 4)];
    let plane = |id: &str, normal: [f64; 3]| TouchedPlane {
        id: id.to_owned(),
        normal: Vector3::from(normal).normalize().into(),
        tilt: [0.1, -0.2],
        offset_m: 0.1,
    };
    device.surroundings.planes = vec![
        plane("table", [0.1, 0.2, 1.0]),
        plane("wall", [1.0, 0.1, 0.2]),
    ];
    device.surroundings.plane_pairs = vec![PlanePair {
        a: "table".to_owned(),
        b: "wall".to_owned(),
        angle_rad: 1.5,
        sd_rad: 1e-3,
    }];
    device.contact_pairs = vec![ContactPair {
        a: "left".to_owned(),
        b: "right".to_owned(),
        distance_m: 0.05,
        sd_m: 1e-4,
    }];
    let mut cable = cable_at([0.9, -0.7, 0.1]);
    cable.exit_axis = Some([-0.8, 0.6, 0.0]);
    (cable.zero_m, cable.scale, cable.exit_radius_m) = (0.01, 1.02, 0.015);
    cable.fit = CableFit {
        anchor: true,
        zero: true,
        scale: true,
        exit_radius: true,
    };
    device.cables = vec![cable];
    device.surroundings.compliance = (0..device.joints.len())
        .map(|joint| JointCompliance {
            rad_per_nm: 1e-3 * (joint % 3) as f64,
            fit: true,
        })
        .collect();
    device
}

/// Readings within +-`range`, one column for each joint.
pub(crate) fn readings(device: &Device, rows: usize, range: f64, seed: u64) -> Vec<Vec<f64>> {
    let joints = device.joints.len();
    let column = |joint: usize| {
        (0..rows)
            .map(|row| range * pseudo_random(seed, (row * joints + joint) as u64))
            .collect()
    };
    (0..joints).map(column).collect()
}

/// A recording with readings alone.
pub(crate) fn plain(joint: Vec<Vec<f64>>) -> Recording {
    let (joints, rows) = (joint.len(), joint[0].len());
    Recording {
        line: (2..2 + rows as u64).collect(),
        joint,
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        ..Recording::default()
    }
}

/// What the tracker sees at every row, with noise of the device's standard deviations times `noise`.
pub(crate) fn tracked(device: &Device, recording: &mut Recording, noise: f64, seed: u64) {
    let (base, tool) = (
        device.surroundings.tracker_base,
        device.surroundings.tracker_tool,
    );
    let (base, tool) = (
        base.unwrap_or_default().pose(),
        tool.unwrap_or_default().pose(),
    );
    let tracker = device.tracker.unwrap();
    let poses = poses(device, recording);
    let mut position = [(); 3].map(|()| Vec::new());
    let mut orientation = [(); 4].map(|()| Vec::new());
    for (row, pose) in poses.iter().enumerate() {
        let number = |index: u64| noise * normal(seed, 6 * row as u64 + index);
        let seen =
            base.rotation * (pose.position_m + pose.rotation * tool.position_m) + base.position_m;
        for axis in 0..3 {
            let error = tracker.position_sd_m.unwrap() * number(axis as u64);
            position[axis].push(seen[axis] + error);
        }
        let wrong =
            Vector3::new(number(3), number(4), number(5)) * tracker.rotation_sd_rad.unwrap();
        let turned = base.rotation * pose.rotation * tool.rotation;
        let turned = Rotation3::new(wrong).into_inner() * turned;
        let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turned));
        for (column, part) in orientation.iter_mut().zip([q.w, q.i, q.j, q.k]) {
            column.push(part);
        }
    }
    recording.position_m = Some(position);
    recording.orientation_wxyz = Some(orientation);
}

/// Handle poses, loads of the device's own masses included.
pub(crate) fn poses(device: &Device, recording: &Recording) -> Vec<Pose> {
    let torques = haptical_model::holding_torques_nm(device, recording).unwrap();
    let mut evaluation = Evaluation::new(device);
    (0..recording.len())
        .map(|row| {
            let angles: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
            if let Some(torques) = &torques {
                let torques: Vec<f64> = torques.iter().map(|column| column[row]).collect();
                evaluation.set_torques(&torques);
            }
            evaluation.move_to(&angles).unwrap();
            *evaluation.pose().unwrap()
        })
        .collect()
}

/// Where the handle must come, as gaps that are zero there.
pub(crate) enum Target {
    Point(Vector3<f64>),
    Plane(Vector3<f64>, f64),
}

/// Readings near `start` at which the handle is where it must be: Newton's steps of least norm, so that the
/// touches of one point are at many postures. None where they do not arrive.
pub(crate) fn touch(device: &Device, start: &[f64], target: &Target) -> Option<Vec<f64>> {
    let mut readings = start.to_vec();
    let mut evaluation = Evaluation::new(device);
    for _ in 0..100 {
        evaluation.move_to(&readings).ok()?;
        let position = evaluation.pose().ok()?.position_m;
        let twists: Vec<Vector3<f64>> = (0..readings.len())
            .map(|joint| evaluation.reading_twist(joint).linear)
            .collect();
        let (gap, pull) = match target {
            Target::Point(point) => {
                let gap = point - position;
                let mut square = haptical_model::kinematics::nalgebra::Matrix3::identity() * 1e-6;
                for twist in &twists {
                    square += twist * twist.transpose();
                }
                (gap.norm(), square.try_inverse()? * gap)
            }
            Target::Plane(normal, offset) => {
                let gap = offset - normal.dot(&position);
                let square: f64 = twists.iter().map(|twist| twist.dot(normal).powi(2)).sum();
                (gap.abs(), normal * (gap / square.max(1e-6)))
            }
        };
        if gap < 1e-14 {
            break;
        }
        let pull = pull * (0.5 / pull.norm()).min(1.0);
        for (reading, twist) in readings.iter_mut().zip(&twists) {
            *reading += twist.dot(&pull);
        }
    }
    evaluation.move_to(&readings).ok()?;
    let position = evaluation.pose().ok()?.position_m;
    let gap = match target {
        Target::Point(point) => (point - position).norm(),
        Target::Plane(normal, offset) => (offset - normal.dot(&position)).abs(),
    };
    let near = readings.iter().all(|reading| reading.abs() < 3.0);
    (gap < 1e-12 && near).then_some(readings)
}

/// `rows` touches of a target from starts all over the workspace.
pub(crate) fn touches(device: &Device, target: &Target, rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut found = Vec::new();
    for attempt in 0..100 * rows as u64 {
        let joints = device.joints.len() as u64;
        let start: Vec<f64> = (0..joints)
            .map(|joint| 1.5 * pseudo_random(seed, attempt * joints + joint))
            .collect();
        found.extend(touch(device, &start, target));
        if found.len() == rows {
            break;
        }
    }
    assert_eq!(found.len(), rows, "the target is out of reach");
    found
}

/// Adds rows to a recording: readings, and the id of what they touch.
pub(crate) fn add_touches(recording: &mut Recording, rows: &[Vec<f64>], id: &str, is_plane: bool) {
    for readings in rows {
        for (column, reading) in recording.joint.iter_mut().zip(readings) {
            column.push(*reading);
        }
        recording.line.push(recording.line.len() as u64 + 2);
    }
    let all = recording.line.len();
    for (own, column) in [
        (!is_plane, &mut recording.contact),
        (is_plane, &mut recording.plane),
    ] {
        if own || column.is_some() {
            let column = column.get_or_insert_with(Vec::new);
            column.resize(all - rows.len(), String::new());
            column.resize(all, if own { id.to_owned() } else { String::new() });
        }
    }
    let pad = |column: &mut Vec<f64>| column.resize(all, f64::NAN);
    recording.position_m.iter_mut().flatten().for_each(pad);
    recording
        .orientation_wxyz
        .iter_mut()
        .flatten()
        .for_each(pad);
    recording.cable_m.iter_mut().flatten().for_each(pad);
}

/// The recording's readings with an error of standard deviation `sd_rad`, which is what makes touches noisy.
pub(crate) fn shaken(recording: &mut Recording, sd_rad: f64, seed: u64) {
    for (joint, column) in recording.joint.iter_mut().enumerate() {
        for (row, reading) in column.iter_mut().enumerate() {
            *reading += sd_rad * normal(seed, (1000 * row + joint) as u64);
        }
    }
}

/// Two sockets that both arms reach.
pub(crate) fn two_points(device: &Device) -> [Vector3<f64>; 2] {
    let near = plain(readings(device, 1, 0.4, 9));
    let first = poses(device, &near)[0].position_m;
    [first, first + Vector3::new(0.03, -0.04, 0.0)]
}
