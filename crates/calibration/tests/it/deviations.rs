//! What a user states of how far numbers of links may be off.

use haptical_calibration::{HeldOut, Options, Weighting, candidate_parameters, fit_device};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Parameter, ParameterId, Recording};

use crate::rig_scene::{Target, add_touches, normal, plain, poses, shaken, table, touches};

/// Joints mounted some degrees off, all else as drawn.
const OFFSETS_RAD: [f64; 5] = [0.0, 0.05, -0.06, 0.04, -0.07];

/// Touches of two planes across each other, some millimetres uncertain.
fn scene() -> (Device, Device, Recording) {
    let mut nominal = table(5);
    nominal.surroundings.plane_sd_m = Some(3e-3);
    let mut truth = nominal.clone();
    for (link, offset) in truth.links[1..].iter_mut().zip(OFFSETS_RAD) {
        link.theta_rad += offset;
    }
    let mut recording = plain(vec![Vec::new(); 5]);
    for (id, normal) in [("table", Vector3::z()), ("wall", Vector3::x())] {
        let rows = touches(&truth, &Target::Plane(normal, 0.3), 40, 7);
        add_touches(&mut recording, &rows, id, true);
    }
    shaken(&mut recording, 4e-3, 3);
    (nominal, truth, recording)
}

fn fitted(nominal: &Device, recording: &Recording) -> Device {
    let options = Options {
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    fit_device(nominal, recording, &options).unwrap().device
}

/// How far the tip's distances between postures are wrong, root mean square: a base at another place is none.
fn wrong_m(found: &Device, truth: &Device) -> f64 {
    let mut elsewhere = plain(vec![Vec::new(); 5]);
    for (joint, column) in elsewhere.joint.iter_mut().enumerate() {
        *column = (0..60)
            .map(|row| 0.7 * normal(90 + joint as u64, row))
            .collect();
    }
    elsewhere.line = (2..62).collect();
    let (found, truth) = (poses(found, &elsewhere), poses(truth, &elsewhere));
    let mut square = 0.0;
    for row in 1..60 {
        let length = |poses: &[haptical_model::kinematics::Pose]| {
            (poses[row].position_m - poses[row - 1].position_m).norm()
        };
        square += (length(&found) - length(&truth)).powi(2);
    }
    (square / 59.0_f64).sqrt()
}

#[test]
fn offsets_are_told_where_lengths_are_held() {
    let (nominal, truth, recording) = scene();
    let mut stated = nominal.clone();
    stated.hold("lengths").unwrap();
    stated.hold("twists").unwrap();
    stated.expect_deviation("offsets", 0.06).unwrap();
    let found = fitted(&stated, &recording);
    for (row, link) in found.links.iter().enumerate() {
        let was = &nominal.links[row];
        if row > 0 {
            assert_eq!(
                (link.a_m, link.d_m, link.alpha_rad),
                (was.a_m, was.d_m, was.alpha_rad)
            );
        }
    }
    let [before, after] = [&nominal, &found].map(|device| wrong_m(device, &truth));
    assert!(after < 0.25 * before, "{before} to {after}");
    // nobody says how large they are: the residual does
    let unstated = wrong_m(&fitted(&nominal, &recording), &truth);
    assert!(unstated < 0.6 * before, "{before} to {unstated}");
}

#[test]
fn what_is_held_is_no_candidate() {
    let (mut device, ..) = scene();
    let count = candidate_parameters(&device).len();
    device.hold("d2").unwrap();
    let left = candidate_parameters(&device);
    let d2 = ParameterId::Link {
        row: 2,
        parameter: Parameter::D,
    };
    assert_eq!(left.len(), count - 1);
    assert!(!left.contains(&d2));
}
