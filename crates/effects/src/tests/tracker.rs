//! What a tracker that is fixed anywhere shows of a joint's error, against moved isometries.

use haptical_model::kinematics::nalgebra::{
    Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3,
};
use haptical_model::{Device, Evaluation, Origin, Placement, RunBase, Tool, Tracker};

use super::rig::{Rig, context, three_joints};
use crate::signal::Signal;
use crate::{Context, Stream};

/// Places far from the chain's own frames, turned about all axes.
const BASE: Origin = Origin {
    position_m: [1.8, -0.7, 0.4],
    orientation_wxyz: [0.5, -0.5, 0.1, 0.7],
};
const TOOL: Origin = Origin {
    position_m: [0.08, -0.05, 0.12],
    orientation_wxyz: [0.7, 0.1, -0.7, 0.1],
};

fn isometry(origin: &Origin) -> Isometry3<f64> {
    let [w, i, j, k] = origin.orientation_wxyz;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(origin.position_m)),
        UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
    )
}

fn placed() -> Rig {
    let mut rig = three_joints();
    let at = |start| Placement {
        start,
        ..Placement::default()
    };
    rig.device.surroundings.tracker_base = Some(at(BASE));
    rig.device.surroundings.tracker_tool = Some(at(TOOL));
    rig
}

/// What the tracker sees at output angles.
fn seen(device: &Device, output: &[f64]) -> Isometry3<f64> {
    seen_from(device, output, (&BASE, &TOOL))
}

fn seen_from(device: &Device, output: &[f64], (base, tool): (&Origin, &Origin)) -> Isometry3<f64> {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_outputs(output).unwrap();
    let pose = evaluation.pose().unwrap();
    let rotation: Matrix3<f64> = pose.rotation;
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    let handle = Isometry3::from_parts(
        Translation3::from(pose.position_m),
        UnitQuaternion::from_rotation_matrix(&rotation),
    );
    isometry(base) * handle * isometry(tool)
}

fn names(context: &Context<'_>) -> Vec<String> {
    context.streams.iter().map(Stream::name).collect()
}

fn on(signal: &Signal, names: &[String], name: &str, row: usize) -> f64 {
    let stream = names.iter().position(|known| known == name).unwrap();
    signal.on(stream).unwrap()[row]
}

#[test]
fn a_tracker_anywhere_sees_an_error_in_its_own_axes_and_at_its_marker() {
    let rig = placed();
    let context = context(&rig.device, &rig.recording);
    let names = names(&context);
    let size = 1e-6;
    for joint in 0..3 {
        let error = vec![size; context.rows()];
        let signal = context.downstream(joint, &error);
        for row in [0, 97, 500] {
            let mut output: Vec<f64> = context.output.iter().map(|column| column[row]).collect();
            let before = seen(&rig.device, &output);
            output[joint] += size;
            let after = seen(&rig.device, &output);
            let way = after.translation.vector - before.translation.vector;
            let turn = (after.rotation * before.rotation.inverse()).scaled_axis();
            for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
                let position = on(&signal, &names, &format!("position.{letter}"), row);
                assert!(
                    (position - way[axis]).abs() < 1e-10,
                    "joint {joint} {letter}: {position:e} for {:e}",
                    way[axis]
                );
                let angle = on(&signal, &names, &format!("orientation.{letter}"), row);
                assert!(
                    (angle - turn[axis]).abs() < 1e-10,
                    "joint {joint} r{letter}"
                );
            }
        }
    }
}

#[test]
fn large_errors_of_all_joints_move_the_marker_as_far_as_the_chain_does() {
    let rig = placed();
    let context = context(&rig.device, &rig.recording);
    let names = names(&context);
    let sizes = [0.05, 0.01, -0.08];
    let errors: Vec<Vec<f64>> = sizes
        .iter()
        .map(|size| vec![*size; context.rows()])
        .collect();
    let signal = context.upstream_of_all(&errors);
    for row in [3, 411] {
        let output: Vec<f64> = context.output.iter().map(|column| column[row]).collect();
        let moved: Vec<f64> = output.iter().zip(sizes).map(|(q, size)| q + size).collect();
        let way = seen(&rig.device, &moved).translation.vector
            - seen(&rig.device, &output).translation.vector;
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let position = on(&signal, &names, &format!("position.{letter}"), row);
            assert!((position - way[axis]).abs() < 1e-12, "{letter}");
        }
    }
}

/// Rows about another tool, or from another place of the tracker, show an error there.
#[test]
fn an_error_shows_at_each_rows_own_tool_and_base() {
    let mut rig = placed();
    let other = Origin {
        position_m: [-0.2, 0.1, 0.05],
        orientation_wxyz: [0.1, 0.7, 0.5, 0.5],
    };
    let at = |start| Placement {
        start,
        ..Placement::default()
    };
    let around = &mut rig.device.surroundings;
    around.tracker_base = None;
    let base = |run, start| RunBase {
        run,
        placement: at(start),
    };
    around.run_bases = vec![base(1, BASE), base(2, other)];
    around.tools = vec![Tool {
        placement: Some(at(other)),
        has_turn: true,
        ..Tool::new("far")
    }];
    rig.device.tracker = Some(Tracker {
        base_known: false,
        base_per_run: true,
        tool_known: false,
        position_sd_m: None,
        rotation_sd_rad: None,
        scale_sd: None,
    });
    let rows = rig.recording.len();
    let id = |row: usize| if row.is_multiple_of(2) { "" } else { "far" };
    rig.recording.tool = Some((0..rows).map(|row| id(row).to_owned()).collect());
    rig.recording.run = Some((0..rows).map(|row| 1 + i64::from(row > rows / 2)).collect());
    let context = context(&rig.device, &rig.recording);
    let names = names(&context);
    let size = 1e-6;
    let signal = context.downstream(1, &vec![size; rows]);
    for row in [0, 1, rows - 2, rows - 1] {
        let own = (
            if row > rows / 2 { &other } else { &BASE },
            if row % 2 == 0 { &TOOL } else { &other },
        );
        let mut output: Vec<f64> = context.output.iter().map(|column| column[row]).collect();
        let before = seen_from(&rig.device, &output, own);
        output[1] += size;
        let after = seen_from(&rig.device, &output, own);
        let way = after.translation.vector - before.translation.vector;
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let position = on(&signal, &names, &format!("position.{letter}"), row);
            assert!((position - way[axis]).abs() < 1e-10, "row {row} {letter}");
        }
    }
}

/// A tracker whose metre is short reads all of a place by a share too much, in its own frame, and turns nothing.
#[test]
fn a_scale_is_that_of_the_place_in_the_trackers_frame() {
    let rig = placed();
    let context = context(&rig.device, &rig.recording);
    let names = names(&context);
    let signal = context.tracker_scaled();
    for row in [0, 97, 500] {
        let output: Vec<f64> = context.output.iter().map(|column| column[row]).collect();
        let place = seen(&rig.device, &output).translation.vector;
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let position = on(&signal, &names, &format!("position.{letter}"), row);
            assert!((position - place[axis]).abs() < 1e-12, "{letter}");
        }
    }
    let turned = names
        .iter()
        .position(|name| name == "orientation.x")
        .unwrap();
    assert!(signal.on(turned).is_none());
}
