//! Effects of the cable's way and of the structure against closed forms, on recordings without noise.

use haptical_simulator::model::kinematics::nalgebra::{Rotation3, Unit, Vector3};
use haptical_simulator::model::kinematics::{Chain, Convention};
use haptical_simulator::model::{Device, Evaluation, Recording};
use haptical_simulator::{Effect, Effects, record_motion};

use crate::hand::{SEED, at_row, cable, heavy_arm, quiet, readings, with};
use crate::inertia::motion_nm;

/// Rounding of angles and lengths below 10.
const ROUNDING: f64 = 1e-12;

/// Way from the first cable's anchor to the handle, and its angle to the direction at home.
fn way(device: &Device, recording: &Recording, row: usize) -> (Vector3<f64>, f64) {
    let place = |row: usize| {
        let position_m = at_row(device, recording, row)
            .pose()
            .expect("a pose")
            .position_m;
        position_m - Vector3::from(device.cables[0].anchor_m)
    };
    (place(row), place(row).angle(&place(0)))
}

#[test]
fn twist_and_guide_follow_the_angle_to_the_exit_axis() {
    let (device, clean) = (heavy_arm(), with(Vec::new()));
    let radius_m = 0.006;
    let twisted = with(vec![Effect::CableTwist {
        twist_m_per_rad2: 2e-3,
    }]);
    let guided = with(vec![Effect::CableExitGeometry { radius_m }]);
    let mut most = 0.0_f64;
    for row in (0..clean.len()).step_by(31) {
        let (way, angle) = way(&device, &clean, row);
        let added = cable(&twisted)[row] - cable(&clean)[row];
        // acos, which the test uses, is good to 1e-8 near the axis
        assert!((added - 2e-3 * angle * angle).abs() < 1e-10);
        // another route to the guide: the length is the least over all angles of leaving it
        let (along, across) = (way.norm() * angle.cos(), way.norm() * angle.sin());
        let wrapped = |psi: f64| {
            let (x, y) = (radius_m * psi.sin(), radius_m * (1.0 - psi.cos()));
            let straight = ((along - x).powi(2) + (across - y).powi(2)).sqrt();
            // how far the straight part is from leaving at a tangent
            let slip = (along - x) * psi.sin() - (across - y) * psi.cos();
            (straight + radius_m * psi, slip)
        };
        let (mut low, mut high) = (0.0_f64, std::f64::consts::PI);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if wrapped(middle).1 < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (want, _) = wrapped(low);
        assert!((cable(&guided)[row] - want).abs() < 1e-9, "{row}");
        most = most.max(want - way.norm());
    }
    assert!(most > 1e-4, "{most}");
    assert!((cable(&guided)[0] - cable(&clean)[0]).abs() < ROUNDING);
}

#[test]
fn an_eccentric_drum_is_right_at_home_and_wrong_once_a_turn() {
    let clean = with(Vec::new());
    let (amplitude_m, phase_rad, radius_m) = (1e-4, 0.8, 0.015);
    let wrong = with(vec![Effect::CableDrumEccentricity {
        amplitude_m,
        phase_rad,
    }]);
    let bump = |reading_m: f64| amplitude_m * (reading_m / radius_m - phase_rad).cos();
    for row in 0..clean.len() {
        let (shown, given) = (cable(&wrong)[row], cable(&clean)[row]);
        let want = bump(shown) - bump(cable(&clean)[0]);
        assert!((shown - given - want).abs() < ROUNDING);
    }
    assert!((cable(&wrong)[0] - cable(&clean)[0]).abs() < ROUNDING);
}

#[test]
fn a_soft_tool_moves_the_handle_along_the_force() {
    let (device, m_per_n) = (heavy_arm(), 3e-5);
    let recording = with(vec![Effect::ToolCompliance { m_per_n }]);
    let force = recording.force_n.as_ref().expect("forces");
    for row in (0..recording.len()).step_by(31) {
        let pose = *at_row(&device, &recording, row).pose().expect("a pose");
        let own = Vector3::new(force[0][row], force[1][row], force[2][row]);
        let handle_m = pose.position_m + pose.rotation * own * m_per_n;
        let want = (handle_m - Vector3::from(device.cables[0].anchor_m)).norm();
        assert!((cable(&recording)[row] - want).abs() < ROUNDING);
    }
}

#[test]
fn a_soft_base_turns_by_the_moment_of_weights_and_hand() {
    let (device, give) = (heavy_arm(), 1e-6);
    let recording = with(vec![Effect::BaseCompliance { rad_per_nm: give }]);
    let force = recording.force_n.as_ref().expect("forces");
    let links = device.chain_links();
    let motions = device.motions();
    let gravity = Vector3::from(device.gravity_mps2.expect("gravity"));
    for row in (0..recording.len()).step_by(97) {
        let evaluation = at_row(&device, &recording, row);
        let angles: Vec<f64> = (0..4).map(|joint| evaluation.output_rad(joint)).collect();
        let frame = |rows: usize| {
            let chain = Chain::new(device.convention, &links[..rows], &motions[..rows]);
            chain
                .expect("rows")
                .pose(&angles[..rows - 1])
                .expect("a pose")
        };
        let base_m = frame(1).position_m;
        let handle = frame(5);
        let own = Vector3::new(force[0][row], force[1][row], force[2][row]);
        let mut moment = (handle.position_m - base_m).cross(&(handle.rotation * own));
        for (row, body) in device.bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            let turn = links[row].theta_rad + angles[row - 1];
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            let before = frame(row);
            let centre = before.rotation * (turn * Vector3::from(body.centre_of_mass_m));
            let place_m = before.position_m + centre;
            moment += (place_m - base_m).cross(&(gravity * body.mass_kg));
        }
        let turned = (moment * give).cross(&(handle.position_m - base_m));
        let way = handle.position_m + turned - Vector3::from(device.cables[0].anchor_m);
        // second order: (1e-6 x 10 rad)^2 x 1 m
        assert!((cable(&recording)[row] - way.norm()).abs() < 1e-9);
        assert!(turned.norm() > 1e-8);
    }
}

#[test]
fn a_wobbling_axis_turns_what_follows_about_the_link_before() {
    for convention in [Convention::Standard, Convention::Modified] {
        let mut device = heavy_arm();
        device.convention = convention;
        let effect = Effect::AxisWobble {
            joint: 2,
            amplitude_rad: 2e-3,
            phase_rad: 0.4,
            order: 2.0,
        };
        let effects = Effects::new(vec![effect]).expect("an effect");
        let recording = record_motion(&device, &effects, &quiet(), SEED).expect("a recording");
        let (mut links, motions) = (device.chain_links(), device.motions());
        // the frame in front of joint 2's turn, whose x axis the axis tilts about
        let rows = match convention {
            Convention::Standard => 2,
            Convention::Modified => 3,
        };
        if convention == Convention::Modified {
            (links[2].theta_rad, links[2].d_m) = (0.0, 0.0);
        }
        for row in (0..recording.len()).step_by(31) {
            let mut evaluation = Evaluation::new(&device);
            evaluation
                .move_to(&readings(&recording, row))
                .expect("a pose");
            let mut angles: Vec<f64> = (0..4).map(|joint| evaluation.output_rad(joint)).collect();
            let handle_m = evaluation.pose().expect("a pose").position_m;
            let tilt = 2e-3 * (2.0 * angles[1] - 0.4).cos();
            angles[1] = 0.0;
            let chain = Chain::new(convention, &links[..rows], &motions[..rows]).expect("rows");
            let front = chain.pose(&angles[..rows - 1]).expect("a pose");
            let axis = Unit::new_normalize(front.rotation.column(0).into_owned());
            let turn = Rotation3::from_axis_angle(&axis, tilt);
            let moved_m = front.position_m + turn * (handle_m - front.position_m);
            let want = (moved_m - Vector3::from(device.cables[0].anchor_m)).norm();
            assert!(
                (cable(&recording)[row] - want).abs() < ROUNDING,
                "{convention:?} {row}"
            );
        }
    }
}

/// Torques of an arm whose base and tool give way, as slopes of the potential energy with the base's
/// turn and the tool's shift (in the handle's frame) held; the turn is found by iteration.
#[test]
fn a_soft_base_and_tool_change_the_torques() {
    const STEP: f64 = 1e-5;
    let (device, rad_per_nm, m_per_n) = (heavy_arm(), 2e-3, 3e-3);
    let recording = with(vec![
        Effect::BaseCompliance { rad_per_nm },
        Effect::ToolCompliance { m_per_n },
    ]);
    let (links, motions) = (device.chain_links(), device.motions());
    let gravity = Vector3::from(device.gravity_mps2.expect("gravity"));
    let frame = |rows: usize, angles: &[f64]| {
        let chain = Chain::new(device.convention, &links[..rows], &motions[..rows]);
        let pose = chain.expect("rows").pose(&angles[..rows - 1]);
        pose.expect("a pose")
    };
    let base_m = frame(1, &[0.0; 4]).position_m;
    let force = recording.force_n.as_ref().expect("forces");
    for row in (0..recording.len()).step_by(197) {
        let own = Vector3::new(force[0][row], force[1][row], force[2][row]);
        let evaluation = at_row(&device, &recording, row);
        let angles: Vec<f64> = (0..4).map(|joint| evaluation.output_rad(joint)).collect();
        // weights and their levers from the base, then the hand's, all with the base unturned
        let levers = |angles: &[f64]| {
            let mut levers = Vec::new();
            for (row, body) in device.bodies.iter().enumerate() {
                let Some(body) = body else { continue };
                let turn = links[row].theta_rad + angles[row - 1];
                let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
                let before = frame(row, angles);
                let centre = before.rotation * (turn * Vector3::from(body.centre_of_mass_m));
                levers.push((before.position_m + centre - base_m, gravity * body.mass_kg));
            }
            let handle = frame(5, angles);
            let hook_m = handle.position_m + handle.rotation * own * m_per_n;
            (levers, hook_m - base_m, handle.rotation * own)
        };
        let (weights, hook_m, hand_n) = levers(&angles);
        let mut turn = Rotation3::identity();
        for _ in 0..60 {
            let mut moment = (turn * hook_m).cross(&(turn * hand_n));
            for (lever_m, weight_n) in &weights {
                moment += (turn * lever_m).cross(weight_n);
            }
            turn = Rotation3::from_scaled_axis(moment * rad_per_nm);
        }
        let force_n = turn * hand_n;
        let moving = motion_nm(&device, &recording, row);
        for joint in 0..4 {
            let energy = |shift: f64| -> f64 {
                let mut angles = angles.clone();
                angles[joint] += shift;
                let (weights, hook_m, _) = levers(&angles);
                let of_weights: f64 = weights
                    .iter()
                    .map(|(lever_m, weight_n)| weight_n.dot(&(turn * lever_m)))
                    .sum();
                -of_weights - force_n.dot(&(turn * hook_m))
            };
            let slope = (energy(STEP) - energy(-STEP)) / (2.0 * STEP);
            let got = recording.torque_nm[joint].as_ref().expect("torques")[row];
            let want = slope + moving[joint];
            assert!(
                (got - want).abs() < 1e-5,
                "row {row}, joint {joint}: {got} {want}"
            );
        }
        let way = base_m + turn * hook_m - Vector3::from(device.cables[0].anchor_m);
        assert!((cable(&recording)[row] - way.norm()).abs() < 1e-11);
    }
}
