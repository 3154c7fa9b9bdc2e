//! Limits of the speed, and the intervals that they are given.

use haptical_servo::Number;

use crate::loops::{Loop, moves, steps};
use crate::servo::{Log, motion};
use crate::{asked, cause, number};

fn limit(log: &Log) -> Option<Number> {
    let answer = asked(log).unwrap();
    let found = cause(&answer, "speed-saturation");
    found.map(|found| number(found, "limit_rad_per_s"))
}

/// Commands of three kinds at some rows a second.
fn command(seed: u64, rows_hz: f64) -> Vec<f64> {
    match seed % 3 {
        0 => steps(seed, rows_hz, 20.0),
        1 => moves(seed, rows_hz, 20.0),
        _ => {
            let course = motion(seed);
            let rows = (20.0 * rows_hz) as u32;
            (0..rows)
                .map(|row| course(2.0 * f64::from(row) / rows_hz))
                .collect()
        }
    }
}

/// A share of the speed that the command's fastest rows have.
fn most(command: &[f64], rows_hz: f64) -> f64 {
    let mut speeds: Vec<f64> = (command.windows(2))
        .map(|pair| (pair[1] - pair[0]).abs() * rows_hz)
        .collect();
    speeds.sort_unstable_by(f64::total_cmp);
    let fast = speeds[speeds.len() * 17 / 20];
    if fast > 0.0 { 0.75 * fast } else { 2.0 }
}

/// A joint that slows down before it is there has a limit that is not lower for it.
#[test]
fn the_interval_of_a_limit_holds_it() {
    let mut held = 0;
    for seed in 0..18 {
        let rows_hz = [100.0, 200.0, 500.0][seed as usize / 3 % 3];
        let command = command(seed, rows_hz);
        let servo = Loop {
            rows_hz,
            holds: seed % 2 == 1,
            lag_s: 0.01 + 0.0015 * seed as f64,
            most_rad_per_s: most(&command, rows_hz),
            ..Loop::default()
        };
        let found = limit(&servo.log(&command, seed)).unwrap();
        let [low, high] = found.ci95;
        held += u32::from((low..=high).contains(&servo.most_rad_per_s));
        let off = found.value / servo.most_rad_per_s - 1.0;
        assert!(off.abs() < 0.005, "{seed}: {servo:?} {found:?}");
    }
    assert!(held >= 17, "{held} of 18");
}

/// A drive that limits its command, and follows that late: another law than the library's, and an interval that is wider for it.
#[test]
fn the_interval_of_a_limit_is_as_wide_as_the_law_is_wrong() {
    let (mut held, mut said) = (0, 0);
    for seed in 0..9 {
        let rows_hz = 200.0;
        let command = command(seed, rows_hz);
        let most = most(&command, rows_hz);
        let mut profile = command.clone();
        for row in 1..profile.len() {
            let step = profile[row] - profile[row - 1];
            profile[row] = profile[row - 1] + step.clamp(-most / rows_hz, most / rows_hz);
        }
        let servo = Loop {
            rows_hz,
            lag_s: 0.015 + 0.0025 * seed as f64,
            ..Loop::default()
        };
        let mut log = servo.log(&profile, seed);
        log.command = command;
        // a search that ends nowhere says nothing
        let Some(found) = limit(&log) else { continue };
        let [low, high] = found.ci95;
        held += u32::from((low..=high).contains(&most));
        said += 1;
    }
    assert!(said >= 7 && held + 1 >= said, "{held} of {said}");
}

/// Some parts of a log have no motion that is fast enough to meet the limit.
#[test]
fn a_limit_that_only_some_moves_meet_is_found() {
    let rows_hz = 200.0;
    let mut command = moves(21, rows_hz, 24.0);
    let rows = command.len();
    for part in [2, 4, 7] {
        let own = part * rows / 8..(part + 1) * rows / 8;
        let last = command[own.start];
        for (row, at) in (0_u32..).zip(&mut command[own.clone()]) {
            *at = last + 0.05 * (1.0 - (4.0 * f64::from(row) / rows_hz).cos());
        }
        // back to the motion without a jump of the command
        let end = command[own.end - 1];
        let rest = &mut command[own.end..];
        let by = rest.first().map_or(0.0, |next| end - next);
        rest.iter_mut().for_each(|at| *at += by);
    }
    let servo = Loop {
        most_rad_per_s: 0.9,
        ..Loop::default()
    };
    let found = limit(&servo.log(&command, 21)).unwrap();
    assert!((found.value / 0.9 - 1.0).abs() < 0.005, "{found:?}");
}
