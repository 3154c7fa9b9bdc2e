//! The choice of a recording: what it shows of candidates, and what it does not.

use std::collections::BTreeMap;

use haptical_diagnosis::{Candidate, DiagnosisError, Question, Settler};
use haptical_model::{Device, Recording};

const DEVICE: &str = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n\
                      drum_distance_m = 0.07\nexternal_encoder_sd_rad = 1e-4\n";

/// A recording of 400 rows along angles and torques.
fn recording(angle: impl Fn(f64) -> f64, torque: impl Fn(f64) -> f64) -> Recording {
    let times: Vec<f64> = (0..400).map(|row| 0.01 * f64::from(row)).collect();
    let angles: Vec<f64> = times.iter().map(|time| angle(*time)).collect();
    // even over +-0.17 mrad
    let noise = |row: usize| 3.4e-4 * ((row * row * 7919 % 10_007) as f64 / 10_007.0 - 0.5);
    let read = angles
        .iter()
        .enumerate()
        .map(|(row, angle)| angle + noise(row));
    Recording {
        line: (2..402).collect(),
        output: vec![Some(read.collect())],
        torque_nm: vec![Some(times.iter().map(|time| torque(*time)).collect())],
        time_s: Some(times),
        joint: vec![angles],
        ..Recording::default()
    }
}

fn candidate(effect: &str, number: (&str, f64), nats_behind: f64) -> Candidate {
    Candidate {
        effect: effect.to_owned(),
        joint: Some(1),
        numbers: BTreeMap::from([(number.0.to_owned(), number.1)]),
        nats_behind,
    }
}

fn question() -> Question {
    let candidates = vec![
        candidate("backlash", ("width_rad", 1e-3), 0.0),
        candidate("capstan-compliance", ("stiffness_nm_per_rad", 1000.0), 1.5),
        candidate("cable-latency", ("latency_s", 1e-3), 2.0),
    ];
    Question::new(candidates, Vec::new()).unwrap()
}

/// The side that drives is that which turns: the torque has the sign of the motion, as both candidates want it.
fn first() -> Recording {
    recording(
        |time| 0.8 * (1.3 * time).sin() + 0.2 * (0.31 * time).cos(),
        |time| (1.3 * time).cos(),
    )
}

#[test]
fn a_motion_without_its_torque_tells_play_from_compliance() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let settler = Settler::new(&device, &first(), &question()).unwrap();
    // a device without a cable has no latency of one
    assert_eq!(settler.question().candidates.len(), 2);
    let still = recording(|_| 0.1, |_| 0.0);
    let to_and_fro = recording(|time| 0.5 * (4.0 * time).sin(), |_| 0.0);
    let of = |next: &Recording| settler.odds(next).unwrap();
    for odds in of(&still) {
        // nothing moves and nothing presses: the odds stay
        assert!(odds.gained_nats() < 0.5, "{odds:?}");
        let behind = if odds.is_true == 0 { 1.5 } else { -1.5 };
        assert!((odds.nats_before - behind).abs() < 1e-12);
    }
    let told = of(&to_and_fro);
    assert!(told.iter().all(|odds| odds.nats_after > 3.0), "{told:?}");
    let both = settler
        .choose(&[still.clone(), to_and_fro, still], 1)
        .unwrap();
    assert_eq!(
        (both.chosen.as_slice(), both.inseparable.len()),
        (&[1][..], 0)
    );
    assert!(both.least_nats().unwrap() > 3.0);
}

#[test]
fn candidates_that_nothing_tells_apart_are_said_to_be_such() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let settler = Settler::new(&device, &first(), &question()).unwrap();
    let still = recording(|_| 0.1, |_| 0.0);
    let chosen = settler.choose(&[still.clone(), still], 2).unwrap();
    assert_eq!(chosen.inseparable, [(0, 1), (1, 0)]);
    assert_eq!(chosen.least_nats(), None);
}

#[test]
fn one_candidate_is_no_question() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let mut one = question();
    one.candidates.remove(0);
    let refused = Settler::new(&device, &first(), &one).unwrap_err();
    assert!(
        matches!(refused, DiagnosisError::NothingToSettle { .. }),
        "{refused}"
    );
}
