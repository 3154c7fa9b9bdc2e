//! Effects on torques that a device has by its file, and those that are asked for.

use haptical_effects::device::attached;
use haptical_model::DeviceEffect;

use super::arm::{Scene, arm};
use super::examined;
use super::found::{holds, only};
use crate::force::asked::ask_torques;

const ROWS: usize = 3000;

/// The same friction of a device that has it by its file is taken off the torques; of one that has half of it, the other half
/// is found.
#[test]
fn what_the_device_has_by_its_file_is_no_gap() {
    let mut scene = Scene::new(11, ROWS);
    for row in 0..ROWS {
        let rate = scene.rate(2, row);
        scene.torque_nm[2][row] += 0.03 * (rate / 0.01).tanh() + 0.02 * rate;
    }
    for row in 0..ROWS {
        scene.force_n[1][row] += 0.12;
    }
    let scale = scene.scales[2];
    let recording = scene.record();
    let with = |share: f64| {
        let numbers = |all: &[(&str, f64)]| {
            let numbers = all.iter().map(|(name, value)| ((*name).to_owned(), *value));
            numbers.collect()
        };
        let mut device = arm();
        device.effects = vec![
            DeviceEffect {
                name: "joint-friction".to_owned(),
                joint: Some(2),
                numbers: numbers(&[
                    ("coulomb_nm", 0.03 * share),
                    ("viscous_nm_s_per_rad", 0.02 * share),
                    ("stribeck_nm", 0.0),
                    ("transition_rad_per_s", 0.01),
                ]),
                // as corrected.toml has it
                fit: true,
                ..DeviceEffect::default()
            },
            DeviceEffect {
                name: "force-bias".to_owned(),
                numbers: numbers(&[("x_n", 0.0), ("y_n", 0.12), ("z_n", 0.0)]),
                fit: true,
                ..DeviceEffect::default()
            },
        ];
        let attached = attached(&mut device, &recording).unwrap();
        // no calibration fits them
        assert!(device.effects.iter().all(|own| own.fitted.is_empty()));
        examined(&attached)
    };
    let answer = with(1.0);
    assert!(
        !answer.significant && answer.findings.is_empty(),
        "{answer:?}"
    );
    let answer = with(0.5);
    let found = only(&answer, "joint-friction", Some(2));
    holds(found, "coulomb_nm", 0.015 / scale, 0.004);
}

/// Friction that is asked for at the joint that rubs is found with its size, and closes the gap of rows that its fit did not
/// see; at another joint, and a bias of the force sensor, are not there.
#[test]
fn what_is_asked_for_is_found_or_said_not_to_be_there() {
    let mut scene = Scene::new(11, ROWS);
    for row in 0..ROWS {
        let rate = scene.rate(2, row);
        scene.torque_nm[2][row] += 0.03 * (rate / 0.01).tanh() + 0.02 * rate;
    }
    let scale = scene.scales[2];
    let recording = scene.record();
    let asked = |name: &str, joint: Option<usize>| DeviceEffect {
        name: name.to_owned(),
        joint,
        fit: true,
        ..DeviceEffect::default()
    };
    let mut device = arm();
    device.effects = vec![
        asked("joint-friction", Some(2)),
        asked("joint-friction", Some(3)),
        asked("force-bias", None),
    ];
    let answers = ask_torques(&device, &recording, &[0, 1, 2]).unwrap();
    let found = answers[0].effect.as_ref().unwrap();
    for (name, truth, most) in [
        ("coulomb_nm", 0.03 / scale, 0.004),
        ("viscous_nm_s_per_rad", 0.02 / scale, 0.008),
    ] {
        let [low, high] = found.intervals[name].map(Option::unwrap);
        assert!((low..=high).contains(&truth), "{name} [{low}, {high}]");
        assert!(high - low < most, "{name} [{low}, {high}]");
    }
    assert!(answers[0].p_value.unwrap() < 1e-12);
    let unseen = answers[0].held_out.as_ref().unwrap();
    assert_eq!(unseen.channel, "torque3");
    assert!(unseen.rms_after < 0.5 * unseen.rms_before, "{unseen:?}");
    for answer in &answers[1..] {
        assert!(answer.p_value.is_none_or(|p| p > 1e-3), "{answer:?}");
    }
    let friction_nm = unseen.rms_before;
    // of a device that has it by its file nothing of it is left
    let mut device = arm();
    device.effects = vec![
        DeviceEffect {
            fit: false,
            ..found.clone()
        },
        asked("force-bias", None),
    ];
    let answer = &ask_torques(&device, &recording, &[1]).unwrap()[0];
    let unseen = answer.held_out.as_ref().unwrap();
    assert!(unseen.rms_before < 0.1 * friction_nm, "{unseen:?}");
}
