//! Laws of loads and geometry, against statics and shapes that are worked out here another way.

use haptical_model::kinematics::nalgebra::{Rotation3, Vector3};
use haptical_model::{Device, Evaluation, Recording};

use super::compare::{added, angles, assert_agree, length_m, on, time_s};
use super::rig::{RUN, Rig, context, rigs, three_joints};
use crate::signal::Signal;

#[test]
fn a_joint_yields_to_its_torque() {
    const STIFFNESS: f64 = 300.0;
    // loads are averaged over nine rows
    const SMOOTHED: f64 = 2e-2;
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let context = context(&device, &recording);
        let given = [("stiffness_nm_per_rad", STIFFNESS)];
        let torque = recording.torque_nm[0].as_ref().unwrap();
        let turned = |row: usize| -torque[row] / STIFFNESS;
        let capstan = added(&context, "capstan-compliance", Some(0), &given);
        assert_agree("out1", on(&capstan, &context, "out1"), turned, SMOOTHED);
        let moved = |row: usize| {
            let mut outputs = angles(&device, time_s(row));
            let before = length_m(&device, &outputs);
            outputs[0] += turned(row);
            length_m(&device, &outputs) - before
        };
        assert_agree("cable", on(&capstan, &context, "cable"), moved, SMOOTHED);
        let joint = added(&context, "joint-compliance", Some(0), &given);
        assert_agree("joint", on(&joint, &context, "cable"), moved, SMOOTHED);
    }
}

#[test]
fn without_torques_masses_and_hand_are_held() {
    // Two links in a vertical plane (Siciliano et al. 2009, section 3.2 and 7.3): by virtual work, gravity
    // -g along y and a hand force F in frame (-1).
    let text = "
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.4
alpha_rad = 0.0
d_m = 0.0
mass_kg = 1.5
centre_of_mass_m = [0.2, 0.03, 0.0]
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
mass_kg = 0.8
centre_of_mass_m = [0.1, 0.0, 0.0]
[[joint]]
transmission = \"direct\"
transmission_ratio = 1.0
home_rad = 0.3
[[joint]]
transmission = \"direct\"
transmission_ratio = 1.0
home_rad = -0.5
[cable_encoder]
distance_sd_m = 1e-5
[gravity]
vector_mps2 = [0.0, -9.81, 0.0]
";
    const G: f64 = 9.81;
    const STIFFNESS: f64 = 500.0;
    let device = Device::from_toml(text, "plane.toml").unwrap().device;
    let mut recording = super::rig::recording(&device, &[false, false]);
    recording.torque_nm = vec![None, None];
    recording.force_n = None;
    let context = context(&device, &recording);
    let first = added(
        &context,
        "joint-compliance",
        Some(0),
        &[("stiffness_nm_per_rad", STIFFNESS)],
    );
    let second = added(
        &context,
        "joint-compliance",
        Some(1),
        &[("stiffness_nm_per_rad", STIFFNESS)],
    );
    let posture = |row: usize| {
        let angles = angles(&device, time_s(row));
        (angles[0] + 0.3, angles[0] + 0.3 + angles[1] - 0.5)
    };
    // heights: m1 (0.2 sin a + 0.03 cos a), m2 (0.4 sin a + 0.1 sin b), b the second link's direction
    let outer = |row: usize| 0.8 * G * 0.1 * posture(row).1.cos();
    let whole = |row: usize| {
        let a = posture(row).0;
        1.5 * G * (0.2 * a.cos() - 0.03 * a.sin()) + 0.8 * G * 0.4 * a.cos() + outer(row)
    };
    let moved = |row: usize, joint: usize, torque: f64| {
        let mut outputs = angles(&device, time_s(row));
        let before = length_m(&device, &outputs);
        outputs[joint] -= torque / STIFFNESS;
        length_m(&device, &outputs) - before
    };
    // the cable ends on the first axis: that joint turns the handle across it
    assert!(super::size(&first) < 1e-12);
    let expected = |row: usize| moved(row, 1, outer(row));
    assert_agree("second", on(&second, &context, "cable"), expected, 5e-3);
    let held = |joint: usize| context.torque_nm[joint].as_ref().unwrap();
    assert_agree("torque 1", held(0), whole, 1e-9);
    assert_agree("torque 2", held(1), outer, 1e-9);
}

#[test]
fn a_joint_turns_the_handle_about_its_own_origin() {
    for rig in rigs() {
        let context = rig.context();
        for joint in 0..rig.device.joints.len() {
            for row in [0, 50, RUN + 7] {
                let Some((axis, arm)) = context.lever(joint, row) else {
                    assert_eq!(rig.device.joints[joint].unit(), "m");
                    continue;
                };
                let moved = axis.cross(&arm) - context.twist[joint][row].linear;
                assert!(moved.norm() < 1e-12, "{} joint {joint}: {moved}", rig.name);
            }
        }
    }
}

#[test]
fn a_yielding_base_turns_with_the_moment_of_the_hand() {
    const RAD_PER_NM: f64 = 1e-4;
    for Rig {
        mut device,
        recording,
        ..
    } in rigs()
    {
        device.bodies.iter_mut().for_each(|body| *body = None);
        let context = context(&device, &recording);
        let signal = added(
            &context,
            "base-compliance",
            None,
            &[("rad_per_nm", RAD_PER_NM)],
        );
        // row 0 alone: where the base is
        let row_0 = device.links[0];
        let turn_x = Rotation3::from_axis_angle(&Vector3::x_axis(), row_0.alpha_rad);
        let base = match device.convention {
            haptical_model::kinematics::Convention::Modified => {
                Vector3::new(row_0.a_m, 0.0, 0.0) + turn_x * Vector3::new(0.0, 0.0, row_0.d_m)
            }
            _ => Vector3::new(row_0.a_m, 0.0, row_0.d_m),
        };
        let force = recording.force_n.as_ref().unwrap();
        let mut evaluation = Evaluation::new(&device);
        let anchor = Vector3::from(device.cables[0].anchor_m);
        let expected: Vec<f64> = (0..2 * RUN)
            .map(|row| {
                evaluation
                    .move_outputs(&angles(&device, time_s(row)))
                    .unwrap();
                let pose = evaluation.pose().unwrap();
                let arm = pose.position_m - base;
                let hand =
                    pose.rotation * Vector3::new(force[0][row], force[1][row], force[2][row]);
                let turn = Rotation3::from_scaled_axis(arm.cross(&hand) * RAD_PER_NM);
                let moved = base + turn * arm;
                (moved - anchor).norm() - (pose.position_m - anchor).norm()
            })
            .collect();
        // forces are averaged over nine rows
        assert_agree(
            &device.name,
            on(&signal, &context, "cable"),
            |row| expected[row],
            3e-2,
        );
    }
}

#[test]
fn a_changed_tool_and_a_yielding_one_move_the_handle() {
    let Rig {
        device, recording, ..
    } = three_joints();
    let context = context(&device, &recording);
    let axes = ["position.x", "position.y", "position.z"];
    let changed = added(&context, "tool-changed", None, &[("shift_m", 2e-3)]);
    let yielding = added(&context, "tool-compliance", None, &[("m_per_n", 1e-5)]);
    let force = recording.force_n.as_ref().unwrap();
    for row in [10, RUN - 10, RUN + 10, 2 * RUN - 10] {
        let length = |signal: &Signal| {
            let squares = axes.map(|axis| on(signal, &context, axis)[row].powi(2));
            squares.iter().sum::<f64>().sqrt()
        };
        let expected = if row < RUN { 0.0 } else { 2e-3 };
        assert!((length(&changed) - expected).abs() < 1e-15, "row {row}");
        let hand = force
            .iter()
            .map(|axis| axis[row].powi(2))
            .sum::<f64>()
            .sqrt();
        assert!(
            (length(&yielding) - 1e-5 * hand).abs() < 0.05 * 1e-5 * hand.max(1.0),
            "row {row}"
        );
    }
}

#[test]
fn an_exit_guide_adds_the_arc_less_the_corner() {
    // a handle straight across the exit axis: from the guide's centre it is at D = L - r, and the cable
    // wraps pi - acos(r / D)
    const RADIUS_M: f64 = 6e-3;
    let text = "
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
[[joint]]
transmission = \"direct\"
transmission_ratio = 1.0
[cable_encoder]
distance_sd_m = 1e-5
exit_axis = [1.0, 0.0, 0.0]
";
    let device = Device::from_toml(text, "guide.toml").unwrap().device;
    let angles = [0.0, std::f64::consts::FRAC_PI_2, 0.4, -0.4];
    let recording = Recording {
        line: vec![2, 3, 4, 5],
        joint: vec![angles.to_vec()],
        output: vec![None],
        cable_m: vec![Some(vec![0.2; 4])],
        torque_nm: vec![None],
        ..Recording::default()
    };
    let context = context(&device, &recording);
    let signal = added(
        &context,
        "cable-exit-geometry",
        None,
        &[("radius_m", RADIUS_M)],
    );
    let found = on(&signal, &context, "cable");
    assert!(found[0].abs() < 1e-15, "{found:?}");
    let far = 0.2 - RADIUS_M;
    let straight = (far * far - RADIUS_M * RADIUS_M).sqrt();
    let across = straight + RADIUS_M * (std::f64::consts::PI - (RADIUS_M / far).acos()) - 0.2;
    assert!((found[1] - across).abs() < 1e-15, "{} {across}", found[1]);
    // a guide all around: either way alike; less bent, less is added
    assert!((found[2] - found[3]).abs() < 1e-15, "{found:?}");
    assert!(found[2] > 0.0 && found[2] < found[1], "{found:?}");
}
