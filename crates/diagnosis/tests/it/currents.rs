//! Motors whose torque follows their current, or not: a law of docs/equations.md, Between current and torque, each.

use haptical_diagnosis::{Diagnosis, DiagnosisError, Options, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::normal::Normal;

const CONSTANT: f64 = 2.5;
const ROWS: usize = 4000;
const STEP_S: f64 = 0.005;

/// What is between a current and its torque, beside the torque constant.
#[derive(Clone, Copy)]
struct Motor {
    offset_nm: f64,
    /// Share by which the constant falls at the largest current.
    falls: f64,
    share_per_s: f64,
    delay_s: f64,
    coulomb_nm: f64,
    /// Where the current ends, though it is logged as it was commanded.
    resistance_ohm: f64,
    current_sd_a: f64,
    torque_sd_nm: f64,
}

const SOUND: Motor = Motor {
    offset_nm: 0.0,
    falls: 0.0,
    share_per_s: 0.0,
    delay_s: 0.0,
    coulomb_nm: 0.0,
    resistance_ohm: 0.0,
    current_sd_a: 0.02,
    torque_sd_nm: 0.1,
};

const LARGEST_A: f64 = 5.0;

fn current_a(time_s: f64) -> f64 {
    3.0 * (2.3 * time_s).sin() + 1.4 * (5.1 * time_s + 0.7).cos() + 0.6 * (0.37 * time_s).sin()
}

fn angle(time_s: f64) -> f64 {
    0.8 * (1.7 * time_s + 0.4).sin() + 0.3 * (4.3 * time_s).cos()
}

fn volts(time_s: f64) -> f64 {
    24.0 - 3.0 * (0.2 * time_s).sin()
}

fn device(joints: usize) -> Device {
    let text = "[[joint]]\ntransmission = \"direct\"\n".repeat(joints);
    Device::from_toml(&text, "motors.toml").unwrap().device
}

fn recorded(motor: &Motor) -> Recording {
    let mut noise = Normal::new(7);
    let times: Vec<f64> = (0..ROWS).map(|row| row as f64 * STEP_S).collect();
    let mut torque = |time_s: f64| {
        let there = time_s - motor.delay_s;
        let speed = (angle(there + 1e-4) - angle(there - 1e-4)) / 2e-4;
        let mut amperes = current_a(there);
        if motor.resistance_ohm > 0.0 {
            let limit = (volts(there) - CONSTANT * speed.abs()) / motor.resistance_ohm;
            amperes = amperes.clamp(-limit, limit);
        }
        let constant = CONSTANT
            * (1.0 - motor.falls * amperes.abs() / LARGEST_A)
            * (1.0 + motor.share_per_s * time_s);
        let friction = motor.coulomb_nm * speed.signum();
        constant * amperes + motor.offset_nm - friction + motor.torque_sd_nm * noise.next()
    };
    let torques = times.iter().map(|time_s| torque(*time_s)).collect();
    let currents = times
        .iter()
        .map(|time_s| current_a(*time_s) + motor.current_sd_a * noise.next());
    Recording {
        line: (2..).take(ROWS).collect(),
        joint: vec![times.iter().map(|time_s| angle(*time_s)).collect()],
        output: vec![None],
        torque_nm: vec![Some(torques)],
        covariates: vec![
            ("current1_a".to_owned(), currents.collect()),
            (
                "supply_v".to_owned(),
                times.iter().map(|time_s| volts(*time_s)).collect(),
            ),
        ],
        time_s: Some(times),
        ..Recording::default()
    }
}

fn diagnosed(recording: &Recording) -> Diagnosis {
    diagnose(
        &device(recording.joint.len()),
        recording,
        &Options::default(),
    )
    .unwrap()
}

/// The cause is the only one, and its number is within its interval, which is no wider than a fifth of it.
fn assert_named(motor: &Motor, effect: &str, number: &str, truth: f64) {
    let found = diagnosed(&recorded(motor));
    let names: Vec<&str> = found.causes.iter().map(|own| own.effect.as_str()).collect();
    assert_eq!(
        (found.verdict, &names[..]),
        (Verdict::Named, &[effect][..]),
        "{:?}",
        found.causes
    );
    let own = &found.causes[0].parameters[number];
    let [low, high] = own.ci95;
    assert!(low <= truth && truth <= high, "{truth} {own:?}");
    assert!(high - low < 0.4 * truth.abs(), "{own:?}");
    let gap = &found.gap.channels[0];
    assert!(gap.rms_after < 1.1 * gap.noise_floor, "{gap:?}");
}

#[test]
fn a_torque_that_follows_its_current_has_no_gap() {
    let noiseless = Motor {
        current_sd_a: 0.0,
        torque_sd_nm: 0.0,
        ..SOUND
    };
    for motor in [SOUND, noiseless] {
        let found = diagnosed(&recorded(&motor));
        assert_eq!(found.verdict, Verdict::NoGap, "{:?}", found.causes);
        assert!(
            found.warnings.iter().all(|own| !own.contains("current")),
            "{:?}",
            found.warnings
        );
    }
}

#[test]
fn a_constant_that_falls_by_a_tenth_at_full_current_is_named() {
    let motor = Motor {
        falls: 0.1,
        ..SOUND
    };
    assert_named(
        &motor,
        "magnetic-saturation",
        "share_per_a",
        0.1 / LARGEST_A,
    );
}

#[test]
fn a_constant_that_falls_over_the_log_is_named() {
    let motor = Motor {
        share_per_s: -0.004,
        ..SOUND
    };
    assert_named(&motor, "torque-constant-drift", "share_per_s", -0.004);
}

#[test]
fn a_constant_that_falls_with_the_temperature_is_not_one_that_falls_with_time() {
    let mut recording = recorded(&SOUND);
    let degrees: Vec<f64> = (0..ROWS)
        .map(|row| 25.0 + 8.0 * (row as f64 * 2e-3).sin())
        .collect();
    for (torque, degree) in recording.torque_nm[0].iter_mut().flatten().zip(&degrees) {
        *torque *= 1.0 - 0.005 * (degree - 25.0);
    }
    recording.temperature_degc = Some(degrees);
    let found = diagnosed(&recording);
    assert_eq!(found.causes[0].effect, "torque-constant-drift");
    let [low, high] = found.causes[0].parameters["share_per_degc"].ci95;
    assert!(low <= -0.005 && -0.005 <= high, "{low} {high}");
}

#[test]
fn a_delay_of_five_milliseconds_is_named() {
    let motor = Motor {
        delay_s: 0.005,
        ..SOUND
    };
    assert_named(&motor, "torque-latency", "delay_s", 0.005);
}

#[test]
fn an_offset_of_the_current_s_sensor_is_named() {
    let motor = Motor {
        offset_nm: 0.4,
        ..SOUND
    };
    assert_named(&motor, "torque-offset", "torque_nm", 0.4);
}

#[test]
fn friction_between_motor_and_torque_sensor_is_no_delay() {
    let motor = Motor {
        coulomb_nm: 0.5,
        ..SOUND
    };
    assert_named(&motor, "joint-friction", "coulomb_nm", 0.5);
}

/// At standstill the supply of 24 V drives 24 / R, which is 2.5 N m each ampere; what the log's mean voltage gives is as much within 3 %.
#[test]
fn a_current_that_the_supply_limits_is_named() {
    let motor = Motor {
        resistance_ohm: 6.0,
        ..SOUND
    };
    let times = (0..ROWS).map(|row| row as f64 * STEP_S);
    let mean = times.map(volts).sum::<f64>() / ROWS as f64;
    assert_named(
        &motor,
        "torque-saturation",
        "limit_nm",
        CONSTANT * mean / 6.0,
    );
}

/// A current that follows the angle: its slope has 0.81 of what friction has of a sine's sides.
#[test]
fn friction_that_is_left_out_passes_for_no_delay() {
    let mut recording = recorded(&SOUND);
    let mut noise = Normal::new(17);
    let angles = &recording.joint[0];
    let currents: Vec<f64> = angles.iter().map(|angle| 3.0 * angle).collect();
    let slopes = (0..ROWS).map(|row| angles[(row + 1).min(ROWS - 1)] - angles[row]);
    let torques = slopes
        .zip(&currents)
        .map(|(slope, current)| CONSTANT * current - 0.6 * slope.signum() + 0.1 * noise.next());
    recording.torque_nm[0] = Some(torques.collect());
    recording.covariates[0].1 = currents;
    let found = diagnosed(&recording);
    assert_eq!(
        found.causes[0].effect, "joint-friction",
        "{:?}",
        found.causes
    );
    let options = Options {
        without: vec!["joint-friction".to_owned()],
        ..Options::default()
    };
    let found = diagnose(&device(1), &recording, &options).unwrap();
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.causes);
}

#[test]
fn noise_with_a_memory_is_no_gap() {
    let mut recording = recorded(&SOUND);
    let (mut noise, mut left) = (Normal::new(19), 0.0);
    for torque in recording.torque_nm[0].iter_mut().flatten() {
        left = 0.95 * left + 0.03 * noise.next();
        *torque += left;
    }
    let found = diagnosed(&recording);
    assert_eq!(found.verdict, Verdict::NoGap, "{:?}", found.causes);
}

#[test]
fn a_late_loop_and_a_motor_that_saturates_are_both_named() {
    let mut recording = recorded(&Motor {
        falls: 0.1,
        ..SOUND
    });
    let commands = (0..ROWS)
        .map(|row| angle(row as f64 * STEP_S + 0.08))
        .collect();
    recording
        .covariates
        .push(("command1_rad".to_owned(), commands));
    let found = diagnosed(&recording);
    let mut names: Vec<&str> = found.causes.iter().map(|own| own.effect.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["command-latency", "magnetic-saturation"]);
    let share: f64 = found.gap.channels.iter().map(|own| own.share_of_gap).sum();
    assert!((share - 1.0).abs() < 1e-9, "{share}");
    // of what a view tests alone no other says that it is untestable
    let untestable = |name: &str| found.untestable.iter().any(|own| own.effect == name);
    assert!(!untestable("magnetic-saturation") && !untestable("command-latency"));
}

#[test]
fn noise_in_the_current_s_place_is_unknown_with_a_warning() {
    let mut recording = recorded(&Motor {
        offset_nm: 1.0,
        ..SOUND
    });
    let mut noise = Normal::new(11);
    recording.covariates[0].1 = (0..ROWS).map(|_| 3.0 * noise.next()).collect();
    let found = diagnosed(&recording);
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.causes);
    assert!(found.causes.is_empty(), "{:?}", found.causes);
    let said = found
        .warnings
        .iter()
        .any(|own| own.contains("does not follow its current"));
    assert!(said, "{:?}", found.warnings);
}

#[test]
fn a_current_of_the_other_sign_is_said() {
    let mut recording = recorded(&SOUND);
    let current = &mut recording.covariates[0].1;
    current.iter_mut().for_each(|value| *value = -*value);
    let answer = diagnosed(&recording);
    assert_eq!(answer.verdict, Verdict::NoGap);
    let said = |word: &str| answer.warnings.iter().any(|own| own.contains(word));
    assert!(said("against its current (-2."), "{:?}", answer.warnings);
    assert!(
        !diagnosed(&recorded(&SOUND))
            .warnings
            .iter()
            .any(|own| own.contains("against"))
    );
}

/// Real: "No gap", 0.0 N m before and after.
#[test]
fn currents_whose_squares_overflow_are_refused() {
    let mut recording = recorded(&SOUND);
    recording.covariates[0].1[70] = 1e300;
    let why = diagnose(&device(1), &recording, &Options::default()).unwrap_err();
    assert!(why.to_string().contains("line 72"), "{why}");
}

/// Real: "a residual of current1 is too large to be squared".
#[test]
fn a_torque_of_zero_is_not_tested() {
    let mut recording = recorded(&SOUND);
    recording.torque_nm = vec![Some(vec![0.0; ROWS])];
    let why = diagnose(&device(1), &recording, &Options::default()).unwrap_err();
    assert!(why.to_string().contains("hardly varies"), "{why}");
}

#[test]
fn a_torque_at_rest_is_not_tested() {
    let mut recording = recorded(&SOUND);
    let mut noise = Normal::new(13);
    recording.torque_nm[0] = Some((0..ROWS).map(|_| 3.0 + 0.1 * noise.next()).collect());
    let refused = diagnose(&device(1), &recording, &Options::default()).unwrap_err();
    assert!(
        matches!(&refused, DiagnosisError::Currents { why } if why.contains("hardly varies")),
        "{refused}"
    );
    assert!(refused.is_unidentifiable());
}

#[test]
fn an_effect_that_is_left_out_is_not_named() {
    let options = Options {
        without: vec!["magnetic-saturation".to_owned()],
        ..Options::default()
    };
    let recording = recorded(&Motor {
        falls: 0.3,
        ..SOUND
    });
    let found = diagnose(&device(1), &recording, &options).unwrap();
    assert!(
        found
            .causes
            .iter()
            .all(|own| own.effect != "magnetic-saturation"),
        "{:?}",
        found.causes
    );
    assert_ne!(found.verdict, Verdict::NoGap);
}

/// Columns of sound motors and of a supply, added to a log with another fault.
#[test]
fn clean_currents_change_no_name_of_the_log_without_them() {
    let mut recording = crate::arm::record_yielding(&crate::arm::Session::default());
    let without = crate::arm::diagnosed(&recording);
    assert_eq!(without.verdict, Verdict::Named);
    let torques: Vec<(usize, Vec<f64>)> = (recording.torque_nm.iter().enumerate())
        .filter_map(|(joint, own)| Some((joint, own.clone()?)))
        .collect();
    assert!(!torques.is_empty());
    for (joint, torque) in torques {
        let currents = torque.iter().map(|own| own / CONSTANT).collect();
        recording
            .covariates
            .push((format!("current{}_a", joint + 1), currents));
    }
    recording
        .covariates
        .push(("supply_v".to_owned(), vec![24.0; recording.len()]));
    let with = crate::arm::diagnosed(&recording);
    assert_eq!(
        (with.verdict, &with.causes),
        (without.verdict, &without.causes)
    );
    assert!(with.gap.channels.len() > without.gap.channels.len());
    assert_eq!(with.place, without.place);
}

/// Other views do not read currents: as covariates they would be asked of what noise does not depend on.
#[test]
fn clean_currents_change_no_test_of_a_clean_log() {
    let session = crate::arm::Session::default();
    let mut recording = crate::arm::record(&session, |_| crate::arm::Errors::default());
    let without = crate::arm::diagnosed(&recording);
    let torque: Vec<f64> = (0..recording.len())
        .map(|row| (row as f64 * 0.01).sin())
        .collect();
    recording.torque_nm[0] = Some(torque.clone());
    let with_torque = crate::arm::diagnosed(&recording);
    let currents = torque.iter().map(|own| own / CONSTANT).collect();
    recording
        .covariates
        .push(("current1_a".to_owned(), currents));
    let with = crate::arm::diagnosed(&recording);
    assert_eq!([without.verdict, with.verdict], [Verdict::NoGap; 2]);
    assert_eq!(with.whiteness, with_torque.whiteness);
}
