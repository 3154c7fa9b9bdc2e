//! A mass on the spring of a loop answers slow commands as a delay does.

use haptical_servo::Verdict;

use crate::loops::{Loop, moves, steps};
use crate::{asked, cause, number};

/// Damping ratios about 0.7, at which it is the hardest to tell.
const DAMPING: [f64; 3] = [0.55, 0.7, 0.85];

fn heavy(damping: f64, rad_per_s: f64) -> Loop {
    Loop {
        lag_s: 2.0 * damping / rad_per_s,
        rad_per_s: Some(rad_per_s),
        ..Loop::default()
    }
}

#[test]
fn a_mass_on_a_spring_is_not_named_a_delay() {
    for (seed, damping) in (0..).zip(DAMPING) {
        for (rad_per_s, holds) in [(45.0, false), (90.0, false), (45.0, true), (120.0, true)] {
            let servo = Loop {
                holds,
                ..heavy(damping, rad_per_s)
            };
            let command = moves(seed, servo.rows_hz, 20.0);
            let answer = asked(&servo.log(&command, seed)).unwrap();
            assert_eq!(answer.verdict, Verdict::Ambiguous, "{servo:?}");
            let main = &answer.causes[0];
            let names = [&[main.effect], &main.confusable_with[..]].concat();
            assert!(names.contains(&"servo-stiffness"), "{servo:?}: {names:?}");
        }
    }
}

/// Steps show the overshoot of a mass: the loop comes first, with its own numbers.
#[test]
fn a_mass_that_steps_show_has_its_lag_and_its_frequency() {
    for (seed, holds) in [(1, false), (2, true)] {
        let servo = Loop {
            holds,
            ..heavy(0.6, 40.0)
        };
        let command = steps(seed, servo.rows_hz, 20.0);
        let answer = asked(&servo.log(&command, seed)).unwrap();
        let main = &answer.causes[0];
        assert_eq!(main.effect, "servo-stiffness", "{main:?}");
        for (name, wanted) in [("lag_s", 0.03), ("natural_rad_per_s", 40.0)] {
            let found = number(main, name);
            assert!((found.value / wanted - 1.0).abs() < 0.01, "{found:?}");
        }
    }
}

#[test]
fn a_delay_that_a_fast_motion_shows_is_named() {
    for (seed, holds) in [(3, false), (4, true)] {
        let servo = Loop {
            delay_s: 0.04,
            lag_s: 0.0,
            holds,
            ..Loop::default()
        };
        let command = steps(seed, servo.rows_hz, 20.0);
        let answer = asked(&servo.log(&command, seed)).unwrap();
        assert_eq!(answer.verdict, Verdict::Named, "{:?}", answer.causes);
        assert_eq!(answer.causes[0].effect, "command-latency");
    }
}

/// Friction in such a loop is a cause next to what makes it late, which is not named alone.
#[test]
fn a_joint_that_sticks_is_not_only_late() {
    for (seed, damping) in (5..).zip(DAMPING) {
        let servo = Loop {
            friction_rad: 0.02,
            ..heavy(damping, 45.0)
        };
        let command = moves(seed, servo.rows_hz, 25.0);
        let answer = asked(&servo.log(&command, seed)).unwrap();
        assert_eq!(answer.verdict, Verdict::Ambiguous, "{:?}", answer.causes);
        let width = number(cause(&answer, "joint-friction").unwrap(), "width_rad");
        assert!((width.value / 0.04 - 1.0).abs() < 0.1, "{width:?}");
    }
}
