//! Logs that say nothing, or something else than their columns' names.

use haptical_servo::{JointLog, Untested, Verdict, diagnose_joint};

use crate::servo::{Log, Servo, motion};
use crate::{asked, cause};

fn sound() -> Log {
    let servo = Servo {
        rad_per_s: Some(30.0),
        offset_rad: 0.05,
        ..Servo::default()
    };
    servo.log(&motion(3), 60.0)
}

fn said(log: &Log) -> String {
    asked(log).unwrap_err().to_string()
}

#[test]
fn a_log_without_commands_or_times_is_refused_in_words() {
    let log = sound();
    let without = |time_s, command| {
        let joint = JointLog {
            time_s,
            command,
            response: &log.response,
            ..JointLog::default()
        };
        diagnose_joint(&joint).unwrap_err()
    };
    assert_eq!(without(Some(&log.time_s), None), Untested::NoCommand);
    assert_eq!(without(None, Some(&log.command)), Untested::NoTime);
}

#[test]
fn a_standstill_is_refused() {
    let mut log = sound();
    log.command.fill(0.2);
    log.response.fill(0.21);
    assert_eq!(asked(&log).unwrap_err(), Untested::Still);
    assert!(said(&log).contains("does not move"));
}

#[test]
fn commands_in_degrees_are_no_gain_of_57() {
    let mut log = sound();
    log.command
        .iter_mut()
        .for_each(|value| *value = value.to_degrees());
    let text = said(&log);
    assert!(text.contains("57.") && text.contains("degrees"), "{text}");
    let mut log = sound();
    log.response
        .iter_mut()
        .for_each(|value| *value = value.to_degrees());
    assert!(said(&log).contains("degrees"));
}

#[test]
fn the_command_of_another_joint_is_refused() {
    let mut log = sound();
    log.command = Servo::default().log(&motion(99), 60.0).command;
    assert!(matches!(
        asked(&log).unwrap_err(),
        Untested::Unrelated { .. }
    ));
}

/// A turned sign is no gain below zero, and no other fault.
#[test]
fn a_command_with_the_other_sign_is_refused() {
    for seed in 0..8 {
        let servo = Servo {
            rad_per_s: Some(30.0),
            ..Servo::default()
        };
        let mut log = servo.log(&motion(seed), 60.0);
        log.command.iter_mut().for_each(|value| *value = -*value);
        assert!(
            matches!(asked(&log).unwrap_err(), Untested::Opposite { .. }),
            "{seed}"
        );
    }
}

#[test]
fn times_in_milliseconds_are_said() {
    let mut log = sound();
    log.time_s.iter_mut().for_each(|value| *value *= 1e3);
    let text = said(&log);
    assert!(
        text.contains("20.000 s apart") && text.contains("milliseconds"),
        "{text}"
    );
}

#[test]
fn few_rows_and_empty_cells_are_counted() {
    let mut log = sound();
    log.command[100..].fill(f64::NAN);
    assert_eq!(asked(&log).unwrap_err(), Untested::Short { rows: 100 });
}

/// An angle that is read within one turn: the jumps are no motion.
#[test]
fn an_angle_that_wraps_is_unwrapped_and_said() {
    let servo = Servo {
        offset_rad: 0.05,
        delay_s: 0.06,
        ..Servo::default()
    };
    let about_half_a_turn = motion(3);
    let mut log = servo.log(&|time_s| 3.1 + about_half_a_turn(time_s), 60.0);
    let whole = asked(&log).unwrap();
    let turn = std::f64::consts::TAU;
    for column in [&mut log.response, &mut log.command] {
        for value in column.iter_mut().filter(|value| **value > 0.5 * turn) {
            *value -= turn;
        }
    }
    // the first row of one may be a turn from the other's
    let answer = asked(&log).unwrap();
    assert!(
        answer.warnings.iter().any(|text| text.contains("wraps")),
        "{:?}",
        answer.warnings
    );
    let offset = |answer| cause(answer, "joint-offset").unwrap().numbers[0].value;
    assert!((offset(&answer) - offset(&whole)).abs() < 1e-6);
}

#[test]
fn times_that_jitter_are_said() {
    let mut log = sound();
    for (row, time_s) in log.time_s.iter_mut().enumerate() {
        *time_s += if row % 3 == 0 { 0.008 } else { 0.0 };
    }
    let answer = asked(&log).unwrap();
    assert!(
        answer.warnings.iter().any(|text| text.contains("vary")),
        "{:?}",
        answer.warnings
    );
    assert_ne!(answer.verdict, Verdict::NoGap);
}

/// Rows without a command cut the log; none is made up.
#[test]
fn rows_without_a_command_are_left_out() {
    let mut log = sound();
    let whole = asked(&log).unwrap();
    log.command[1000..1100].fill(f64::NAN);
    let answer = asked(&log).unwrap();
    assert_eq!(answer.course.row.len(), log.command.len() - 100);
    let offset = |answer| cause(answer, "joint-offset").unwrap().numbers[0].value;
    assert!((offset(&answer) - offset(&whole)).abs() < 1e-3);
}

/// A joint that is switched off half way is no servo of another gain.
#[test]
fn a_joint_that_stops_while_its_command_goes_on_is_said_with_its_time() {
    let mut log = sound();
    let half = log.response.len() / 2;
    let last = log.response[half];
    log.response[half..].iter_mut().for_each(|at| *at = last);
    let Untested::Stopped { from_s } = asked(&log).unwrap_err() else {
        panic!("{}", said(&log));
    };
    // the motion rests for a second now and then
    assert!((from_s - log.time_s[half]).abs() < 1.2, "{from_s}");
    assert!(asked(&log).unwrap_err().is_foreign());
    // a joint that rests with its command has not stopped
    let mut log = sound();
    for column in [&mut log.response, &mut log.command] {
        let last = column[half];
        column[half..].iter_mut().for_each(|at| *at = last);
    }
    assert!(asked(&log).is_ok(), "{}", said(&log));
}
