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
