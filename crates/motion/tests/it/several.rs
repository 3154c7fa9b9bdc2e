//! Readings that are off as a whole, alone and with another effect.

use haptical_model::Recording;
use haptical_motion::{Change, Examined, Finding, examine};

use super::arm::{Truth, device, recording};

fn examined(log: &Recording) -> Examined {
    examine(&device(), log, None, &[]).unwrap()
}

fn names(found: &Examined) -> Vec<(&str, Option<usize>)> {
    let mut names: Vec<_> = (found.findings.iter())
        .map(|entry| (entry.effect, entry.joint))
        .collect();
    names.sort_unstable();
    names
}

fn number(found: &Finding) -> (f64, f64) {
    let (_, value, sd) = found.numbers[0];
    (value, sd)
}

/// The links stand behind what is read, and what they are off by turns with them: a zero of 0.2 rad, whose torques are no multiple of their
/// slope, has its size and its interval.
#[test]
fn a_joints_zero_has_its_size_whatever_the_bodies_are_off_by() {
    let mut held = 0;
    for seed in 1..=8 {
        let mut log = recording(Truth::default(), seed);
        log.joint[1].iter_mut().for_each(|at| *at -= 0.2);
        let found = examined(&log);
        assert_eq!(names(&found), [("joint-offset", Some(1))], "seed {seed}");
        let (offset_rad, sd) = number(&found.findings[0]);
        assert!((offset_rad - 0.2).abs() < 0.02, "seed {seed}: {offset_rad}");
        assert!(sd < 0.02, "seed {seed}: {sd}");
        held += usize::from((offset_rad - 0.2).abs() < 2.0 * sd);
    }
    assert!(held >= 7, "{held} of 8 intervals hold the zero");
}

#[test]
fn a_factor_on_all_torques_is_found_next_to_a_payload() {
    for seed in 1..=4 {
        let truth = Truth {
            payload_kg: 1.0,
            ..Truth::default()
        };
        let mut log = recording(truth, seed);
        for column in log.torque_nm.iter_mut().flatten() {
            column.iter_mut().for_each(|torque| *torque *= 0.5);
        }
        let found = examined(&log);
        // in a plane what hangs at the flange is what the last link weighs more
        let [body, scale] = names(&found)[..] else {
            panic!("seed {seed}: {:?}", found.findings);
        };
        let is_body = [("payload", None), ("link-inertia", Some(1))].contains(&body);
        assert!(
            is_body && scale == ("torque-gain", None),
            "seed {seed}: {body:?}"
        );
        let gain = found
            .findings
            .iter()
            .find(|entry| entry.effect == "torque-gain");
        let (factor, sd) = number(gain.unwrap());
        assert!(
            (factor - 0.5).abs() < 3.0 * sd && sd < 0.05,
            "seed {seed}: {factor} +- {sd}"
        );
    }
}

/// Of two effects each explains a part of what the other does until both are there: none is kept that another one explains far better then.
#[test]
fn an_effect_that_was_taken_early_makes_room_for_a_better_one() {
    for seed in 1..=6 {
        let truth = Truth {
            tilt_rad: 0.1,
            ..Truth::default()
        };
        let mut log = recording(truth, seed);
        let column = log.torque_nm[1].as_mut().unwrap();
        column.iter_mut().for_each(|torque| *torque += 1.5);
        let found = examined(&log);
        assert!(
            found.findings.len() > 1,
            "seed {seed}: {:?}",
            found.findings
        );
        for entry in &found.findings {
            let ahead = entry.rivals.iter().find(|rival| rival.behind_nats < -5.0);
            assert_eq!(ahead, None, "seed {seed}: in the place of {entry:?}");
        }
    }
}

#[test]
fn late_positions_are_torques_that_a_file_says_are_early() {
    let truth = Truth {
        late_s: 0.015,
        ..Truth::default()
    };
    let found = examined(&recording(truth, 1));
    let Some(Change::TorqueDelay {
        joint: None,
        more_s,
    }) = found.findings[0].change
    else {
        panic!("{:?}", found.findings);
    };
    assert!((more_s + 0.015).abs() < 1e-3, "{more_s}");
    let mut later = device();
    later.joints[1].torque_delay_s = Some(0.002);
    let change = found.findings[0].change.unwrap();
    let delays = change.applied(&later).unwrap().joints;
    let delays = delays.iter().map(|joint| joint.torque_delay_s.unwrap());
    let delays: Vec<f64> = delays.map(|delay_s| delay_s - more_s).collect();
    assert!((delays[0].abs() < 1e-15) && (delays[1] - 0.002).abs() < 1e-15);
}

/// What the base model adjusts of the bodies is what they are off by, as far as the torques show it.
#[test]
fn bodies_are_those_of_the_fit() {
    let (log, factor) = super::arm::with_factors(Truth::default(), 3);
    let found = examined(&log);
    let bodies = found.bodies.iter();
    let fitted = bodies.fold(device(), |device, change| change.applied(&device).unwrap());
    // the weight of both links at the first joint, with the lever of 0.4 m
    let weight = |device: &haptical_model::Device| {
        let body = |row: usize| device.bodies[row].unwrap();
        let moment = |row: usize| {
            body(row).mass_kg * (body(row).centre_of_mass_m[0] + 0.4 * (row as f64 - 1.0))
        };
        moment(1) + moment(2)
    };
    let upper = 3.0 * 0.2 * factor[0];
    let fore = 2.0 * (0.4 + 0.15) * factor[1];
    let [before, after] =
        [weight(&device()), weight(&fitted)].map(|entry| (entry - upper - fore).abs());
    assert!(after < 0.3 * before, "{after} of {before} is left");
}

/// A drag that grows with the square of the speed bends friction as Stribeck's does, and has no name in the catalogue.
#[test]
fn a_drag_of_the_speeds_square_is_no_stribeck_friction() {
    for seed in 1..=3 {
        let mut log = recording(Truth::default(), seed);
        let step_s = log.time_s.as_ref().unwrap()[1];
        let at = log.joint[0].clone();
        let column = log.torque_nm[0].as_mut().unwrap();
        for row in 1..at.len() - 1 {
            let dq = (at[row + 1] - at[row - 1]) / (2.0 * step_s);
            column[row] += 1.5 * dq * dq.abs();
        }
        let found = examined(&log);
        assert!(found.has_gap(), "seed {seed}");
        let is_answer = found.is_answer();
        let has_name = names(&found)
            .iter()
            .any(|entry| entry.0 == "stribeck-friction");
        assert!(
            !(is_answer && has_name),
            "seed {seed}: {:?}",
            found.findings
        );
    }
}

/// What oscillates faster than the motion counts as its noise, and is said.
#[test]
fn an_oscillation_beyond_the_band_is_said() {
    let mut log = recording(Truth::default(), 2);
    assert_eq!(examined(&log).oscillations, []);
    let time_s = log.time_s.clone().unwrap();
    let column = log.torque_nm[1].as_mut().unwrap();
    for (torque, time_s) in column.iter_mut().zip(time_s) {
        *torque += (std::f64::consts::TAU * 60.0 * time_s).sin();
    }
    let found = examined(&log);
    let [(1, line)] = found.oscillations[..] else {
        panic!("{:?}", found.oscillations);
    };
    assert!((line.hz - 60.0).abs() < 0.2, "{line:?}");
    assert!((line.amplitude - 1.0).abs() < 0.05, "{line:?}");
}

/// A hundredth of the dry friction is part of the floor.
#[test]
fn the_law_of_friction_is_part_of_the_noise() {
    let floor = |rough_nm: f64| {
        let truth = Truth {
            rough_nm,
            ..Truth::default()
        };
        examined(&recording(truth, 1)).channels[0].noise
    };
    let (usual, rough) = (floor(0.0), floor(200.0));
    assert!(
        (rough.hypot(-usual) / 2.0 - 1.0).abs() < 0.05,
        "{usual} {rough}"
    );
}

/// What a large effect's law may be off by has no name.
#[test]
fn an_offset_of_a_hundredth_of_a_payload_is_no_further_cause() {
    for seed in 1..=3 {
        let has_offset = |offset_nm: f64| {
            let truth = Truth {
                payload_kg: 3.0,
                offset_nm,
                ..Truth::default()
            };
            let found = examined(&recording(truth, seed));
            assert!(found.is_answer(), "seed {seed}: {:?}", found.findings);
            names(&found).contains(&("torque-offset", Some(0)))
        };
        assert!(!has_offset(0.2), "seed {seed}");
        assert!(has_offset(6.0), "seed {seed}");
    }
}

#[test]
fn a_zero_of_some_milliradians_is_calibration() {
    for seed in 1..=4 {
        let mut log = recording(Truth::default(), seed);
        log.joint[1].iter_mut().for_each(|at| *at -= 0.008);
        let found = examined(&log);
        assert!(!found.has_gap(), "seed {seed}");
        assert_eq!(names(&found), [], "seed {seed}");
    }
}
