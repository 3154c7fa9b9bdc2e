//! The choice of a recording: what it shows of candidates, and what it does not.

use std::collections::BTreeMap;

use haptical_diagnosis::{Candidate, DiagnosisError, Odds, Question, Settler, inseparable, score};
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
fn a_recording_at_rest_tells_play_and_compliance_nothing_and_a_motion_does() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let settler = Settler::new(&device, &first(), &question()).unwrap();
    // a device without a cable has no latency of one
    assert_eq!(settler.question().candidates.len(), 2);
    // where it stands, and what presses on it, does not matter as long as nothing changes
    let still = recording(|_| 0.1, |_| 0.0);
    let pressed = recording(|_| -0.4, |_| 2.0);
    let to_and_fro = recording(|time| 0.5 * (4.0 * time).sin(), |_| 0.0);
    let of = |next: &Recording| settler.odds(next).unwrap();
    let none = of(&still);
    for (odds, pressed) in none.iter().zip(of(&pressed)) {
        let behind = if odds.is_true == 0 { 1.5 } else { -1.5 };
        assert!((odds.nats_before - behind).abs() < 1e-12);
        assert!(odds.gained_nats() < 0.1, "{odds:?}");
        assert!(pressed.gained_nats() < 0.1, "{pressed:?}");
    }
    let told = of(&to_and_fro);
    assert!(told.iter().all(|odds| odds.nats_after > 3.0), "{told:?}");
    assert!(score(&told, &[]) > score(&none, &[]) + 3.0);
    let both = settler.pieces(&[still.clone(), to_and_fro, still]).unwrap();
    assert_eq!(settler.choose(&both, 1), [1]);
    assert_eq!(inseparable(&[&both.of_all]), []);
}

#[test]
fn candidates_that_nothing_tells_apart_are_said_to_be_such() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let settler = Settler::new(&device, &first(), &question()).unwrap();
    let still = recording(|_| 0.1, |_| 0.0);
    let pieces = settler.pieces(&[still.clone(), still]).unwrap();
    let lost = inseparable(&[&pieces.of_all]);
    assert!(lost.contains(&(1, 0)), "{:?}", pieces.of_all);
    // one recording that tells them apart is enough
    let told = settler.odds(&recording(|time| 0.5 * (4.0 * time).sin(), |_| 0.0));
    assert_eq!(inseparable(&[&pieces.of_all, &told.unwrap()]), []);
    assert_eq!(Odds::least_nats(&pieces.of_all, &[(0, 1), (1, 0)]), None);
}

/// 60 s at 20 rows a second, warm: the temperature stays, or it settles with the time.
fn drifting(travel: impl Fn(f64) -> f64, torque: impl Fn(f64) -> f64, is_warm: bool) -> Recording {
    let times: Vec<f64> = (0..1200).map(|row| 0.05 * f64::from(row)).collect();
    let angles: Vec<f64> = times.iter().map(|time| travel(*time)).collect();
    let noise = |row: usize| 3.4e-4 * ((row * row * 7919 % 10_007) as f64 / 10_007.0 - 0.5);
    let read = angles
        .iter()
        .enumerate()
        .map(|(row, angle)| angle + noise(row));
    let degc = |time: &f64| {
        if is_warm {
            30.0
        } else {
            30.0 - 8.0 * (-time / 35.0).exp()
        }
    };
    Recording {
        line: (2..1202).collect(),
        output: vec![Some(read.collect())],
        torque_nm: vec![Some(times.iter().map(|time| torque(*time)).collect())],
        temperature_degc: Some(times.iter().map(degc).collect()),
        time_s: Some(times),
        joint: vec![angles],
        ..Recording::default()
    }
}

#[test]
fn a_creep_and_a_drift_stay_open_however_long_the_same_is_recorded() {
    let device = Device::from_toml(DEVICE, "one.toml").unwrap().device;
    let travel = |time: f64| 0.8 * (1.3 * time).sin();
    // a torque that does not change at all tells of no creep
    let load = |time: f64| 1.0 + 0.05 * (0.7 * time).sin();
    let back = |time: f64| -load(time);
    // 1 N m over 0.66 rad/s of mean travel creeps as fast as the drift
    let mut drift = candidate("joint-drift", ("rad_per_s", 2.0e-5), 0.0);
    drift.numbers.insert("time_constant_s".to_owned(), 0.0);
    drift.numbers.insert("over_s".to_owned(), 0.0);
    let creep = candidate("capstan-creep", ("creep_per_nm", 3.0e-5), 1.0);
    let question = Question::new(vec![drift, creep], Vec::new()).unwrap();
    let settler = Settler::new(&device, &drifting(travel, load, false), &question).unwrap();
    // the raw odds of either are beyond all doubt: 1.2 mrad at the end, noise of 0.1 mrad
    let of = |next: Recording| settler.odds(&next).unwrap();
    for again in [false, true] {
        for odds in of(drifting(travel, load, again)) {
            assert!(odds.nats_after < 1.4, "{again} {odds:?}");
        }
    }
    // a load of the other sign creeps back while the drift goes on; where the temperature follows the time again, it could
    // be the temperature that the drift follows
    let is_drift = |odds: &&Odds| odds.is_true == 0;
    let told = of(drifting(travel, back, true));
    assert!(told.iter().all(|odds| odds.nats_after > 2.5), "{told:?}");
    let cold = of(drifting(travel, back, false));
    assert!(
        cold.iter().find(is_drift).unwrap().nats_after < 1.4,
        "{cold:?}"
    );
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
