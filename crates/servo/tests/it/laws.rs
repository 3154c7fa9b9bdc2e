//! Each law by itself, and several together.

use haptical_servo::Verdict;

use crate::servo::{Servo, motion};
use crate::{asked, cause, number};

/// A loop of 40 rad/s: half a tenth of a second late.
fn loop_of(friction_rad: f64) -> Servo {
    Servo {
        rad_per_s: Some(40.0),
        friction_rad,
        ..Servo::default()
    }
}

#[test]
fn a_joint_that_stands_where_it_is_told_shows_no_gap() {
    for seed in 0..8 {
        let answer = asked(&Servo::default().log(&motion(seed), 60.0)).unwrap();
        assert_eq!(
            answer.verdict,
            Verdict::NoGap,
            "{seed}: {:?}",
            answer.causes
        );
        assert!(answer.causes.is_empty());
    }
}

/// A lag has the size 2 / 40 s here; of a sound servo nothing else may be said.
#[test]
fn a_lag_is_all_that_a_clean_servo_shows() {
    for seed in 0..8 {
        let answer = asked(&loop_of(0.0).log(&motion(seed), 60.0)).unwrap();
        let main = answer.causes.first().unwrap();
        assert!(["command-latency", "servo-stiffness"].contains(&main.effect));
        assert!(answer.closed > 0.95, "{seed}: {}", answer.closed);
        assert!(
            (main.numbers[0].value - 0.05).abs() < 0.006,
            "{seed}: {main:?}"
        );
        let others = answer.causes[1..].iter().filter(|cause| cause.share > 0.05);
        assert_eq!(others.count(), 0, "{seed}: {:?}", answer.causes);
        assert!(answer.causes.iter().all(|cause| cause.since.is_none()));
    }
}

/// A pure delay is told from a lag; the same delay before a lag is not, and says so.
#[test]
fn a_delay_is_named_and_a_lag_is_ambiguous() {
    let late = Servo {
        delay_s: 0.06,
        ..Servo::default()
    };
    for seed in 0..4 {
        let answer = asked(&late.log(&motion(seed), 60.0)).unwrap();
        let main = cause(&answer, "command-latency").unwrap();
        assert_eq!(answer.verdict, Verdict::Named, "{seed}");
        let delay = number(main, "delay_s").value;
        assert!((delay - 0.06).abs() < 0.001, "{seed}: {delay}");
        let answer = asked(&loop_of(0.0).log(&motion(seed), 60.0)).unwrap();
        assert_eq!(answer.verdict, Verdict::Ambiguous, "{seed}");
    }
}

#[test]
fn an_offset_has_its_size() {
    for (seed, offset_rad) in [(1, 0.05), (2, -0.02), (3, 0.3)] {
        let servo = Servo {
            offset_rad,
            ..loop_of(0.0)
        };
        let answer = asked(&servo.log(&motion(seed), 60.0)).unwrap();
        let found = number(cause(&answer, "joint-offset").unwrap(), "offset_rad");
        assert!((found.value - offset_rad).abs() < 1e-3, "{found:?}");
        let [low, high] = found.ci95.map(|end| end - found.value);
        assert!(low < 0.0 && (low + high).abs() < 1e-12, "{found:?}");
        // without gravity's course it may be a droop
        let rivals = &cause(&answer, "joint-offset").unwrap().confusable_with;
        assert_eq!(rivals[..], ["servo-stiffness"]);
    }
}

#[test]
fn friction_has_the_width_of_its_band() {
    for (seed, half) in [(1, 0.02), (2, 0.04), (3, 0.01)] {
        let answer = asked(&loop_of(half).log(&motion(seed), 90.0)).unwrap();
        let found = cause(&answer, "joint-friction").unwrap();
        let width = number(found, "width_rad").value;
        assert!((width / (2.0 * half) - 1.0).abs() < 0.2, "{half}: {width}");
        assert_eq!(found.confusable_with[..], ["dead-zone", "backlash"]);
    }
}

#[test]
fn a_hidden_gain_has_its_factor() {
    for (seed, gain) in [(1, 1.5), (2, 0.5), (3, 1.1)] {
        let servo = Servo {
            gain,
            ..loop_of(0.0)
        };
        let answer = asked(&servo.log(&motion(seed), 60.0)).unwrap();
        let found = cause(&answer, "servo-gain");
        let found = found.unwrap_or_else(|| panic!("{gain}: {answer:?}", answer = answer.causes));
        assert!(
            (number(found, "factor").value - gain).abs() < 0.02,
            "{found:?}"
        );
        // a tenth may be gravity's doing, a half is not
        assert_eq!(
            found.confusable_with.is_empty(),
            (gain - 1.0_f64).abs() > 0.3
        );
    }
}

/// Noise with a memory of a second is no law of a servo.
#[test]
fn noise_with_a_memory_has_no_cause() {
    use rand::{RngExt, SeedableRng};
    for seed in 0..8 {
        let mut log = Servo::default().log(&motion(seed), 60.0);
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(100 + seed);
        let mut noise = 0.0;
        for value in &mut log.response {
            noise = 0.98 * noise + random.random_range(-0.003..0.003);
            *value += noise;
        }
        let answer = asked(&log).unwrap();
        assert_eq!(
            answer.verdict,
            Verdict::Unknown,
            "{seed}: {:?}",
            answer.causes
        );
        assert!(
            answer.causes.iter().all(|cause| cause.since.is_none()),
            "{seed}"
        );
    }
}

/// A known torque of gravity makes a droop a stiffness.
#[test]
fn a_droop_under_a_known_torque_is_a_stiffness() {
    use haptical_servo::{JointLog, diagnose_joint};
    let servo = Servo {
        droop_rad: 0.06,
        ..loop_of(0.005)
    };
    // wide, so that the torque varies, and slow, so that the lag is not all of the gap
    let wide = motion(5);
    let log = servo.log(&|time_s| 4.0 * wide(0.3 * time_s), 180.0);
    // 30 N m/rad: 1.8 N m where the arm is level
    let load_nm: Vec<f64> = log.response.iter().map(|angle| 1.8 * angle.cos()).collect();
    let answer = diagnose_joint(&JointLog {
        time_s: Some(&log.time_s),
        command: Some(&log.command),
        response: &log.response,
        load_nm: Some(&load_nm),
        ..JointLog::default()
    })
    .unwrap();
    let mut causes = answer
        .causes
        .iter()
        .filter(|cause| cause.effect == "servo-stiffness");
    let stiff = causes.find_map(|cause| {
        let mut numbers = cause.numbers.iter();
        numbers.find(|number| number.name == "stiffness_nm_per_rad")
    });
    let stiff = stiff.unwrap_or_else(|| panic!("{:?}", answer.causes));
    assert!((stiff.value / 30.0 - 1.0).abs() < 0.1, "{stiff:?}");
}

/// A drive that is at its limit for most of a motion is far from every lag and delay.
#[test]
fn a_limit_of_the_speed_is_found_where_the_joint_is_always_at_it() {
    for (seed, share) in [(1, 0.4), (2, 0.5), (3, 0.3)] {
        let mut log = Servo::default().log(&motion(seed), 60.0);
        let step_s = log.time_s[1] - log.time_s[0];
        let steps = log.command.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let most = share * steps.fold(0.0, f64::max);
        let mut at = log.command[0];
        for (response, command) in log.response.iter_mut().zip(&log.command) {
            at += (command - at).clamp(-most, most);
            let count_rad = Servo::default().count_rad;
            *response = (at / count_rad).round() * count_rad;
        }
        let answer = asked(&log).unwrap();
        let found = cause(&answer, "speed-saturation").unwrap();
        let limit = number(found, "limit_rad_per_s").value;
        let wanted = most / step_s;
        assert!(
            (limit / wanted - 1.0).abs() < 0.02,
            "{seed}: {limit} for {wanted}"
        );
    }
}
