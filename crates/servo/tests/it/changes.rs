//! What changes within a log is found, sized and placed; what does not is not.

use crate::servo::{Log, Servo, motion};
use crate::{asked, cause};

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
