//! What changes within a log is found, sized and placed; what does not is not.

use crate::loops::{Loop, moves, steps};
use crate::servo::{Log, Servo, motion};
use haptical_servo::{Finding, JointLog, diagnose_joint};

use crate::{asked, cause, number};

fn hobby() -> Servo {
    Servo {
        rad_per_s: Some(30.0),
        friction_rad: 0.015,
        offset_rad: 0.01,
        delay_s: 0.02,
        ..Servo::default()
    }
}

/// Forty servos and motions: a change in any of them is a false alarm.
#[test]
fn sound_logs_show_no_change() {
    for seed in 0..40 {
        let servo = Servo {
            friction_rad: 0.002 * (seed % 10) as f64,
            damping: 0.6 + 0.1 * (seed % 7) as f64,
            ..hobby()
        };
        let answer = asked(&servo.log(&motion(seed), 60.0)).unwrap();
        let changes = answer.causes.iter().filter(|cause| cause.since.is_some());
        assert_eq!(changes.count(), 0, "{seed}: {:?}", answer.causes);
    }
}

/// The instant, within the interval that is said and a fifth of a second of the likeliest.
fn assert_placed(answer: &haptical_servo::JointAnswer, effect: &str, size: f64, at_s: f64) {
    let found = answer.causes.iter().find(|own| own.since.is_some());
    let found = found.unwrap_or_else(|| panic!("{effect}: {:?}", answer.causes));
    assert_eq!(found.effect, effect, "{found:?}");
    assert!(
        (found.numbers[0].value / size - 1.0).abs() < 0.1,
        "{found:?}"
    );
    let [first, at, last] = found.since.unwrap().time_s;
    assert!((at - at_s).abs() < 0.2, "{found:?}");
    assert!(first <= at_s + 0.03 && at_s - 0.03 <= last, "{found:?}");
}

#[test]
fn an_offset_of_five_degrees_is_placed() {
    for seed in 0..8 {
        let mut log = hobby().log(&motion(seed), 60.0);
        let at = 700 + 200 * seed as usize;
        let size = 5_f64.to_radians();
        log.response[at..]
            .iter_mut()
            .for_each(|value| *value += size);
        assert_placed(
            &asked(&log).unwrap(),
            "joint-offset",
            size,
            0.02 * at as f64,
        );
    }
}

/// A joint that breaks away late after a rest looks late: of eight, one may be missed, and the instant may be that of the rest
/// before it in two.
#[test]
fn two_rows_more_of_delay_are_found() {
    let (mut found, mut near) = (0, 0);
    for seed in 0..8 {
        let log = hobby().log(&motion(seed), 60.0);
        let at = 1200 + 100 * seed as usize;
        let mut late = log.clone();
        late.response[at..].copy_from_slice(&log.response[at - 2..log.response.len() - 2]);
        let answer = asked(&late).unwrap();
        let mut changes = answer.causes.iter().filter(|own| own.since.is_some());
        let Some(change) = changes.next() else {
            continue;
        };
        found += 1;
        assert_eq!(change.effect, "command-latency", "{seed}: {change:?}");
        assert!((change.numbers[0].value - 0.04).abs() < 0.011, "{change:?}");
        let [first, likeliest, last] = change.since.unwrap().time_s;
        let at_s = 0.02 * at as f64;
        assert!((likeliest - at_s).abs() < 1.2, "{seed}: {change:?}");
        assert!(last - first < 8.0, "{seed}: {change:?}");
        near += usize::from((first - 0.2..=last + 0.2).contains(&at_s));
    }
    assert!(found >= 7 && near >= 5, "{found} found, {near} near");
}

#[test]
fn a_gain_of_two_is_placed() {
    for seed in 0..8 {
        let mut log = hobby().log(&motion(seed), 60.0);
        let at = 1000 + 100 * seed as usize;
        log.response[at..]
            .iter_mut()
            .for_each(|value| *value *= 2.0);
        let answer = asked(&log).unwrap();
        let found = answer.causes.iter().find(|own| own.since.is_some());
        let found = found.unwrap_or_else(|| panic!("{seed}: {:?}", answer.causes));
        assert_eq!(found.effect, "servo-gain", "{seed}");
        assert!(
            (found.numbers[0].value - 2.0).abs() < 0.15,
            "{seed}: {found:?}"
        );
        let [_, at_s, _] = found.since.unwrap().time_s;
        assert!((at_s - 0.02 * at as f64).abs() < 0.2, "{seed}: {found:?}");
    }
}

/// Episodes as LeRobot records them: times begin anew, and a joint lost 17 degrees between two of them.
#[test]
fn a_change_between_episodes_names_both() {
    let mut all = Log::default();
    for episode in 0..50 {
        let mut log = hobby().log(&motion(1000 + episode), 8.0);
        let lost = if episode >= 42 {
            17_f64.to_radians()
        } else {
            0.0
        };
        log.response.iter_mut().for_each(|value| *value -= lost);
        all.time_s.append(&mut log.time_s);
        all.run.extend(vec![episode as i64; log.command.len()]);
        all.command.append(&mut log.command);
        all.response.append(&mut log.response);
    }
    let answer = asked(&all).unwrap();
    let found = cause(&answer, "joint-offset").unwrap();
    let since = found.since.unwrap();
    assert_eq!(since.between_runs, Some([41, 42]), "{found:?}");
    assert_eq!(since.to_string(), "between runs 41 and 42");
    assert!(
        (found.numbers[0].value + 17_f64.to_radians()).abs() < 5e-3,
        "{found:?}"
    );
    assert_eq!(
        answer
            .causes
            .iter()
            .filter(|own| own.since.is_some())
            .count(),
        1
    );
}

/// A joint whose command stands still shows an offset, and nothing of friction's slips.
#[test]
fn a_joint_at_rest_shows_a_lost_offset_alone() {
    let mut log = Servo::default().log(&|_| 0.4, 60.0);
    assert!(asked(&log).is_err());
    log.response[1500..]
        .iter_mut()
        .for_each(|value| *value += 0.3);
    let answer = asked(&log).unwrap();
    let found = cause(&answer, "joint-offset").unwrap();
    assert!((found.since.unwrap().time_s[1] - 30.0).abs() < 0.03);
    for value in &mut log.response[1500..] {
        *value -= 0.29;
    }
    assert!(asked(&log).is_err());
}

/// A log with the velocity that the drive reports: of the reading before, in steps of 0.0767 rad/s.
fn with_velocity(log: &Log) -> Vec<f64> {
    let rows = log.response.len();
    let speed = |row: usize| (log.command[row] - log.command[row - 1]) / 0.02;
    let own = (0..rows).map(|row| if row == 0 { 0.0 } else { speed(row) });
    own.map(|speed| (speed / 0.0767).round() * 0.0767).collect()
}

/// One row more in the positions, which the velocities do not share: found in every log and placed, and no command's own.
#[test]
fn positions_that_come_a_row_later_than_their_velocities_are_placed() {
    for seed in 0..8 {
        let servo = Servo {
            friction_rad: 0.0,
            rad_per_s: None,
            ..hobby()
        };
        let mut log = servo.log(&motion(seed), 60.0);
        let velocity = with_velocity(&log);
        let asked = |log: &Log| {
            diagnose_joint(&JointLog {
                time_s: Some(&log.time_s),
                command: Some(&log.command),
                response: &log.response,
                velocity: Some(&velocity),
                ..JointLog::default()
            })
            .unwrap()
        };
        let changes = |log: &Log| -> Vec<Finding> {
            let causes = asked(log).causes;
            causes
                .into_iter()
                .filter(|own| own.since.is_some())
                .collect()
        };
        assert_eq!(changes(&log), [], "{seed}");
        let at = 1100 + 137 * seed as usize;
        let before = log.response.clone();
        log.response[at..].copy_from_slice(&before[at - 1..before.len() - 1]);
        let found = changes(&log);
        assert_eq!(found.len(), 1, "{seed}: {found:?}");
        assert_eq!(found[0].effect, "command-latency");
        assert_eq!(found[0].confusable_with[..], ["encoder-latency"], "{seed}");
        assert!(
            (found[0].numbers[0].value - 0.02).abs() < 0.004,
            "{found:?}"
        );
        let [first, likeliest, last] = found[0].since.unwrap().time_s;
        let at_s = 0.02 * at as f64;
        // the motion rests for a second in five
        let rests = at_s % 5.0 > 3.8;
        assert!(
            (likeliest - at_s).abs() < if rests { 1.0 } else { 0.2 },
            "{seed}: {found:?}"
        );
        assert!(
            first <= at_s + 0.03 && at_s - 0.03 <= last,
            "{seed}: {found:?}"
        );
    }
}

/// While the joint rests nothing shows: the interval holds the rest, and the instant is where it moves again.
#[test]
fn a_delay_that_grows_in_a_long_rest_lies_within_it() {
    let moving = motion(4);
    let rests = |time_s: f64| {
        moving(if time_s < 24.0 {
            time_s
        } else {
            (time_s - 12.0).max(24.0)
        })
    };
    let mut log = Servo {
        delay_s: 0.02,
        ..Servo::default()
    }
    .log(&rests, 72.0);
    let before = log.response.clone();
    // in the middle of a rest from 24 to 37 s
    log.response[1500..].copy_from_slice(&before[1498..before.len() - 2]);
    let answer = asked(&log).unwrap();
    let found = answer
        .causes
        .iter()
        .find(|own| own.since.is_some())
        .unwrap();
    let [first, at, last] = found.since.unwrap().time_s;
    assert!(
        (23.5..25.5).contains(&first) && (36.8..37.3).contains(&last),
        "{found:?}"
    );
    assert!((36.8..37.3).contains(&at), "{found:?}");
}

/// Seven steps: another answer to one of them is no delay.
#[test]
fn one_step_that_answers_otherwise_is_no_delay() {
    for odd in 3..6 {
        let steps = |time_s: f64| 0.3 * f64::from((time_s / 10.0) as u32 % 2);
        let mut log = hobby().log(&steps, 80.0);
        let start = 500 * odd;
        let before = log.response.clone();
        log.response[start..start + 100].copy_from_slice(&before[start - 3..start + 97]);
        let answer = asked(&log).unwrap();
        let changes = answer.causes.iter().filter(|own| own.since.is_some());
        assert_eq!(changes.count(), 0, "{odd}: {:?}", answer.causes);
    }
}

/// Episodes whose levels scatter by what the joint carries and where friction leaves it: the loss stands out of them, or is none.
#[test]
fn a_loss_between_episodes_that_scatter_is_placed() {
    use rand::{RngExt, SeedableRng};
    for (seed, lost_rad) in [(1, -0.2967), (2, 0.2967), (3, 0.0), (4, 0.0), (5, 0.0)] {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut all = Log::default();
        for episode in 0..60 {
            let servo = Servo {
                friction_rad: 0.05,
                offset_rad: random.random_range(-0.08..0.08),
                ..hobby()
            };
            let mut log = servo.log(&motion(100 * seed + episode), 5.0);
            let lost = if episode >= 42 { lost_rad } else { 0.0 };
            log.response.iter_mut().for_each(|value| *value += lost);
            all.time_s.append(&mut log.time_s);
            all.run.extend(vec![episode as i64; log.command.len()]);
            all.command.append(&mut log.command);
            all.response.append(&mut log.response);
        }
        let causes = asked(&all).unwrap().causes;
        let found: Vec<&Finding> = causes.iter().filter(|own| own.since.is_some()).collect();
        if lost_rad == 0.0 {
            assert!(found.is_empty(), "{seed}: {found:?}");
            continue;
        }
        assert_eq!(found.len(), 1, "{seed}: {found:?}");
        assert_eq!(found[0].effect, "joint-offset");
        assert_eq!(
            found[0].since.unwrap().between_runs,
            Some([41, 42]),
            "{found:?}"
        );
        // levels of 60 episodes that scatter by 0.05 rad know a step to 0.013
        let [low, high] = found[0].numbers[0].ci95;
        assert!(
            (0.5 * (low + high) - lost_rad).abs() < 0.04,
            "{seed}: {found:?}"
        );
        assert!((0.03..0.12).contains(&(high - low)), "{seed}: {found:?}");
    }
}

/// 1000 rows a second: a delay that is longer than so many rows is no change.
#[test]
fn a_fast_log_has_no_change_that_is_not_there() {
    for seed in 0..4 {
        let servo = Loop {
            rows_hz: 1000.0,
            holds: true,
            delay_s: 0.03 + 0.005 * seed as f64,
            lag_s: 0.04 + 0.02 * seed as f64,
            ..Loop::default()
        };
        let command = match seed % 2 {
            0 => steps(seed, 1000.0, 20.0),
            _ => moves(seed, 1000.0, 20.0),
        };
        let answer = asked(&servo.log(&command, seed)).unwrap();
        let changes = answer.causes.iter().filter(|cause| cause.since.is_some());
        assert_eq!(changes.count(), 0, "{seed}: {:?}", answer.causes);
    }
}

/// And one that is there has its size, though it is many rows.
#[test]
fn a_delay_that_changes_in_a_fast_log_has_its_size() {
    let (mut before, rows_hz) = (Loop::default(), 1000.0);
    (before.rows_hz, before.delay_s) = (rows_hz, 0.02);
    let after = Loop {
        delay_s: 0.045,
        ..before
    };
    for seed in 0..3 {
        let command = moves(seed, rows_hz, 30.0);
        let mut log = before.log(&command, seed);
        let half = log.response.len() / 2;
        log.response[half..].clone_from_slice(&after.log(&command, seed).response[half..]);
        let answer = asked(&log).unwrap();
        let found = answer.causes.iter().find(|cause| cause.since.is_some());
        let found = found.unwrap_or_else(|| panic!("{seed}: {:?}", answer.causes));
        let delay = number(found, "delay_s");
        assert!((delay.value - 0.025).abs() < 0.005, "{seed}: {delay:?}");
        let at = found.since.unwrap().time_s;
        assert!(at[0] < 15.2 && at[2] > 14.8, "{seed}: {at:?}");
    }
}
