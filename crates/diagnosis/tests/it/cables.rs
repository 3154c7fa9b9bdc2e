//! A wrist whose cables play and pull at each other's joints, all in one log.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::normal::Normal;

const JOINTS: usize = 3;
const ROWS: usize = 3000;
const STEP_S: f64 = 0.05;
const OUTPUT_SD_RAD: f64 = 4e-3;
/// Half of each cable's play \[rad\].
const HALF_PLAYS_RAD: [f64; JOINTS] = [0.03, 0.08, 0.15];
/// Turn of joint 3 by the motor of joint 2.
const GAIN: f64 = 0.2;
/// What joint 2 shows of the play of joint 3's cable, which runs over it.
const SHOWN: f64 = -0.8;

fn device() -> Device {
    let mut text = String::from("[device]\nname = \"wrist\"\ndof = 3\n");
    for _ in 0..JOINTS {
        text += &format!(
            "[[joint]]\nlower_rad = -1.4\nupper_rad = 1.4\ntransmission = \"direct\"\n\
             encoder_counts_per_rev = 1000000\nexternal_encoder_sd_rad = {OUTPUT_SD_RAD}\n"
        );
    }
    Device::from_toml(&text, "wrist.toml").unwrap().device
}

/// What a play of half width `b` lags behind a motion by: Prandtl's element.
fn lag(motor: &[f64], b: f64) -> Vec<f64> {
    let mut link = motor[0];
    let at = |reading: &f64| {
        link = link.clamp(reading - b, reading + b);
        link - reading
    };
    motor.iter().map(at).collect()
}

fn motors() -> Vec<Vec<f64>> {
    let waves = [[0.31, 0.83, 1.7], [0.27, 0.97, 1.3], [0.37, 0.71, 1.9]];
    let at = |waves: &[f64; 3], row: usize| {
        let time_s = STEP_S * row as f64;
        let sum: f64 = waves.iter().map(|rate| (rate * time_s).sin()).sum();
        0.42 * sum
    };
    let of_joint = |waves| (0..ROWS).map(|row| at(waves, row)).collect();
    waves.iter().map(of_joint).collect()
}

fn recorded(seed: u64, scale: f64) -> Recording {
    let motor = motors();
    let lags: Vec<Vec<f64>> = motor
        .iter()
        .zip(HALF_PLAYS_RAD)
        .map(|(motor, half)| lag(motor, scale * half))
        .collect();
    let mut normal = Normal::new(seed);
    let mut output = |joint: usize| -> Option<Vec<f64>> {
        let at = |row: usize| {
            let mut angle = motor[joint][row] + lags[joint][row];
            if joint == 1 {
                angle += SHOWN * lags[2][row];
            }
            if joint == 2 {
                angle += scale * GAIN * motor[1][row];
            }
            angle + OUTPUT_SD_RAD * normal.next()
        };
        Some((0..ROWS).map(at).collect())
    };
    Recording {
        line: (2..ROWS as u64 + 2).collect(),
        time_s: Some((0..ROWS).map(|row| STEP_S * row as f64).collect()),
        output: (0..JOINTS).map(&mut output).collect(),
        torque_nm: vec![None; JOINTS],
        joint: motor,
        ..Recording::default()
    }
}

fn answer(recording: &Recording, names: &[&str]) -> Diagnosis {
    let options = Options {
        without: names.iter().map(|name| (*name).to_owned()).collect(),
        ..Options::default()
    };
    diagnose(&device(), recording, &options).unwrap()
}

fn found(diagnosis: &Diagnosis) -> Vec<(&str, Option<usize>)> {
    let causes = diagnosis.causes.iter();
    causes
        .map(|cause| (cause.effect.as_str(), cause.joint))
        .collect()
}

#[test]
fn play_and_coupling_of_several_cables_are_named_together() {
    for seed in [1, 2, 3] {
        let diagnosis = answer(&recorded(seed, 1.0), &[]);
        let found = found(&diagnosis);
        assert_ne!(
            diagnosis.verdict,
            Verdict::Unknown,
            "seed {seed}: {found:?}"
        );
        assert_ne!(diagnosis.verdict, Verdict::NoGap, "seed {seed}: {found:?}");
        let has = |names: &[&str], joint: usize| {
            let of_joint =
                |(name, at): &(&str, Option<usize>)| names.contains(name) && *at == Some(joint);
            found.iter().any(of_joint)
        };
        assert!(has(&["cross-coupling"], 3), "seed {seed}: {found:?}");
        assert!(has(&["coupled-backlash"], 2), "seed {seed}: {found:?}");
        for joint in [2, 3] {
            assert!(
                has(&["backlash", "hysteresis"], joint),
                "seed {seed}: {found:?}"
            );
        }
        assert!(!has(&["cross-coupling"], 2), "seed {seed}: {found:?}");
    }
}

#[test]
fn without_their_names_plays_have_no_other() {
    // a loop in an encoder alone is a twin of one in its drive
    let names = [
        "backlash",
        "hysteresis",
        "coupled-backlash",
        "external-encoder-windup",
    ];
    for seed in [1, 2, 3] {
        let diagnosis = answer(&recorded(seed, 1.0), &names);
        if diagnosis.verdict != Verdict::Unknown {
            let found = found(&diagnosis);
            let is_coupling = |(name, _): &(&str, Option<usize>)| *name == "cross-coupling";
            assert!(found.iter().all(is_coupling), "seed {seed}: {found:?}");
        }
    }
}

#[test]
fn a_sound_wrist_has_no_gap() {
    for seed in [1, 2, 3] {
        let diagnosis = answer(&recorded(seed, 0.0), &[]);
        assert_eq!(diagnosis.verdict, Verdict::NoGap, "seed {seed}");
    }
}

/// Of 21 postures no interval of an angle has enough for a mean: the place is said without one.
#[test]
fn the_place_of_few_postures_is_a_number_or_none() {
    let rows: Vec<usize> = (0..21).map(|k| k * ROWS / 21).collect();
    let diagnosis = answer(&recorded(1, 1.0).select(&rows), &[]);
    let text = serde_json::to_string(&diagnosis).unwrap();
    assert!(!text.contains("NaN"), "{text}");
}
