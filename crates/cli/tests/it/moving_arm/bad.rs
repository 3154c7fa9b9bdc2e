//! Bad logs of a moving arm: clear words, no invented cause, no gap that is said to be none.

use super::log::{Arm, Log, Noise, URDF};
use super::{Trial, told, warns};
use crate::text;

/// Spoilt torques get no name, and their gap is one.
fn assert_unknown(spoil: impl Fn(&mut Log), words: &[&str]) {
    let answer = Trial::with(spoil).answer("arm.urdf", "log.csv", &[]);
    assert_eq!(
        told(&answer),
        ("unknown".to_owned(), Vec::new()),
        "{}",
        answer["answer"]
    );
    assert!(warns(&answer, words), "{words:?}: {}", answer["warnings"]);
}

/// The log is sound once it is read as it was meant.
fn assert_no_gap(spoil: impl Fn(&mut Log), words: &[&str]) {
    let answer = Trial::with(spoil).answer("arm.urdf", "log.csv", &[]);
    assert_eq!(
        told(&answer),
        ("no-gap".to_owned(), Vec::new()),
        "{}",
        answer["answer"]
    );
    assert!(warns(&answer, words), "{words:?}: {}", answer["warnings"]);
}

/// The log is refused.
fn assert_refused(spoil: impl Fn(&mut Log), status: i32, words: &[&str]) {
    let trial = Trial::with(spoil);
    let output = trial.diagnose("arm.urdf", "log.csv", &[]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{said}");
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!trial.path("out").join("gap.json").exists());
}

fn scale(values: &mut [f64], factor: f64) {
    values.iter_mut().for_each(|own| *own *= factor);
}

#[test]
fn torques_of_the_other_sign() {
    let words = [
        "torque2_nm",
        "against the torque that the links ask for",
        "no cause is named",
    ];
    assert_unknown(|log| scale(&mut log.torque_nm[1], -1.0), &words);
    let words = ["torque1_nm", "against the torque that the links ask for"];
    assert_unknown(
        |log| log.torque_nm.iter_mut().for_each(|own| scale(own, -1.0)),
        &words,
    );
}

#[test]
fn torques_in_newton_millimetres_and_currents() {
    let words = [
        "multiples of it",
        "torque1_nm",
        "torque2_nm",
        "N mm",
        "currents",
    ];
    assert_unknown(
        |log| log.torque_nm.iter_mut().for_each(|own| scale(own, 1000.0)),
        &words,
    );
    let of_currents = |log: &mut Log| {
        for (own, constant) in log.torque_nm.iter_mut().zip([14.9, 11.1]) {
            scale(own, 1.0 / constant);
        }
    };
    assert_unknown(of_currents, &words);
}

#[test]
fn torques_that_belong_to_nothing() {
    let rows = |log: &Log| log.time_s.len();
    // rows in another order, noise, the log backwards, another log's
    let shuffled = |log: &mut Log| {
        let mut noise = Noise(9);
        for row in (1..rows(log)).rev() {
            let other = (noise.uniform() * (row + 1) as f64) as usize;
            log.torque_nm
                .iter_mut()
                .for_each(|own| own.swap(row, other));
        }
    };
    assert_unknown(shuffled, &["torque1_nm", "does not follow the motion"]);
    let noisy = |log: &mut Log| {
        let mut noise = Noise(9);
        for own in &mut log.torque_nm {
            own.iter_mut().for_each(|own| *own = 5.0 * noise.normal());
        }
    };
    assert_unknown(noisy, &["torque1_nm", "does not follow the motion"]);
    for spoil in [
        (|log| log.torque_nm.iter_mut().for_each(|own| own.reverse())) as fn(&mut Log),
        |log| log.torque_nm = Log::of(Arm::default(), 77).torque_nm,
    ] {
        assert_unknown(spoil, &[]);
    }
}

#[test]
fn torques_that_are_lost_in_noise() {
    let drown = |log: &mut Log| {
        let mut noise = Noise(9);
        for own in &mut log.torque_nm {
            own.iter_mut()
                .for_each(|own| *own += 3000.0 * noise.normal());
        }
    };
    assert_refused(drown, 3, &["the torques are noise alone"]);
}

#[test]
fn a_torque_that_was_not_measured() {
    for (value, words) in [
        (
            5.0,
            [
                "torque2_nm",
                "is 5 throughout",
                "nothing is said of joint 2",
            ],
        ),
        (
            0.0,
            [
                "torque2_nm",
                "is 0 throughout",
                "nothing is said of joint 2",
            ],
        ),
        (
            f64::NAN,
            ["torque2_nm", "no row has a reading", "taken as absent"],
        ),
    ] {
        assert_no_gap(|log| log.torque_nm[1].fill(value), &words);
    }
    let all = |log: &mut Log| log.torque_nm.iter_mut().for_each(|own| own.fill(5.0));
    assert_refused(all, 3, &["every torque column has one value throughout"]);
}

#[test]
fn time_stamps_that_jitter() {
    for size in [0.001, 0.0035] {
        let jitter = |log: &mut Log| {
            let mut noise = Noise(9);
            let uniform = |noise: &mut Noise| size * (noise.uniform() - 0.5);
            log.time_s
                .iter_mut()
                .for_each(|own| *own += 1.2 * uniform(&mut noise));
        };
        assert_no_gap(
            jitter,
            match size > 0.002 {
                true => &["off an even grid", "taken as evenly spaced"],
                false => &[],
            },
        );
    }
}

#[test]
fn times_in_milliseconds() {
    assert_refused(
        |log| scale(&mut log.time_s, 1000.0),
        3,
        &["is t_s in milliseconds"],
    );
}

#[test]
fn positions_that_wrap() {
    use std::f64::consts::{PI, TAU};
    let wrap = |log: &mut Log| {
        for own in &mut log.theta_rad[0] {
            // the encoder begins anew at half a turn less
            *own = (*own + 0.2).rem_euclid(TAU) - 0.2;
            assert!(*own >= -PI);
        }
    };
    assert_no_gap(wrap, &["theta1_rad", "jumps by a whole turn", "undone"]);
}

#[test]
fn positions_in_degrees() {
    let in_degrees = |log: &mut Log| scale(&mut log.theta_rad[0], 180.0 / std::f64::consts::PI);
    assert_refused(
        in_degrees,
        2,
        &["looks like degrees", "theta1_rad", "pi/180"],
    );
    // a device without limits
    let trial = Trial::with(in_degrees);
    let free = URDF
        .replace(
            "<limit lower=\"-4\" upper=\"4\" effort=\"200\" velocity=\"5\"/>",
            "",
        )
        .replace(
            "<limit lower=\"-4\" upper=\"4\" effort=\"100\" velocity=\"5\"/>",
            "",
        )
        .replace("\"revolute\"", "\"continuous\"");
    std::fs::write(trial.path("free.urdf"), free).unwrap();
    let answer = trial.answer("free.urdf", "log.csv", &[]);
    assert_eq!(
        told(&answer),
        ("unknown".to_owned(), Vec::new()),
        "{}",
        answer["answer"]
    );
    let words = ["theta1_rad", "is the column in degrees", "pi/180"];
    assert!(warns(&answer, &words), "{}", answer["warnings"]);
}

#[test]
fn a_description_without_inertials() {
    let trial = Trial::new(Arm::default());
    let mut bare = String::new();
    let mut rest = URDF;
    while let Some((before, behind)) = rest.split_once("<inertial>") {
        bare.push_str(before);
        rest = behind.split_once("</inertial>").unwrap().1;
    }
    bare.push_str(rest);
    std::fs::write(trial.path("bare.urdf"), bare).unwrap();
    let answer = trial.answer("bare.urdf", "log.csv", &[]);
    let words = [
        "the equations of motion were not used",
        "no mass of row 1 (`mass_kg`)",
        "slow motion",
    ];
    assert!(warns(&answer, &words), "{}", answer["warnings"]);
    for untold in ["payload", "link-inertia", "armature", "encoder-latency"] {
        assert!(!told(&answer).1.iter().any(|own| own == untold), "{answer}");
    }
    let said = trial.check(&trial.path("bare.urdf"));
    assert!(
        said.contains(
            "The equations of motion cannot be used: the device file has no mass of row 1"
        ),
        "{said}"
    );
}

#[test]
fn an_arm_that_stands_still() {
    let still = |log: &mut Log| log.theta_rad.iter_mut().for_each(|own| own.fill(0.3));
    assert_refused(still, 3, &["no joint moves in the log"]);
}

#[test]
fn one_joint_that_moves_alone() {
    let trial = Trial::new(Arm {
        rests: true,
        ..Arm::default()
    });
    let answer = trial.answer("arm.urdf", "log.csv", &[]);
    assert_eq!(
        told(&answer),
        ("no-gap".to_owned(), Vec::new()),
        "{}",
        answer["answer"]
    );
    let words = [
        "joint 2: still throughout",
        "nothing is said of friction, gain, armature",
    ];
    assert!(warns(&answer, &words), "{}", answer["warnings"]);
    let said = trial.check(&trial.path("arm.urdf"));
    assert!(
        said.contains("Still throughout") && said.contains("joint 2"),
        "{said}"
    );
}

#[test]
fn a_log_that_is_too_short_or_too_slow() {
    let cut = |log: &mut Log, every: usize, rows: usize| {
        let keep =
            |own: &mut Vec<f64>| *own = own.iter().copied().step_by(every).take(rows).collect();
        keep(&mut log.time_s);
        log.theta_rad.iter_mut().for_each(keep);
        log.torque_nm.iter_mut().for_each(keep);
    };
    assert_refused(
        |log| cut(log, 1, 60),
        3,
        &["no piece of the log", "is long enough"],
    );
    // 10 rows a second are not judged as a slow motion's: this arm moves
    assert_refused(
        |log| cut(log, 20, 4000),
        3,
        &[
            "10.000 rows a second are too few",
            "20 rows a second are needed",
        ],
    );
}
