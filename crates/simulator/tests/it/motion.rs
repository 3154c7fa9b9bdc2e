//! The way of the hand: bounds, smoothness, home, rests, range.

use haptical_simulator::model::Device;
use haptical_simulator::{HandMotion, Motion, SimulatorError};
use proptest::prelude::*;

use crate::device::arm;
use crate::hand::largest;

/// Rounding of a few products of numbers near 1.
const ROUNDING: f64 = 1e-9;

fn limits(device: &Device, joint: usize, motion: &HandMotion) -> (f64, f64) {
    if device.joints[joint].unit() == "m" {
        (motion.speed_m_per_s, motion.acceleration_m_per_s2)
    } else {
        (motion.speed_rad_per_s, motion.acceleration_rad_per_s2)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_instant_is_within_limits_speed_and_acceleration(
        seed: u64,
        seconds in 3.0f64..60.0,
        range_share in 0.1f64..1.0,
        rests in 0usize..5,
        speed_rad_per_s in 0.3f64..4.0,
    ) {
        let device = arm();
        let bounds = HandMotion {
            seconds, range_share, rests, speed_rad_per_s,
            home_rest_s: 0.7,
            ..HandMotion::default()
        };
        let motion = Motion::new(&device, &bounds, seed).expect("a motion");
        for joint in 0..4 {
            let of = &device.joints[joint];
            let (speed, acceleration) = limits(&device, joint, &bounds);
            for step in 0..2000 {
                let at = motion.joint_motion(joint, seconds * f64::from(step) / 2000.0);
                prop_assert!(at.position >= range_share * of.lower_rad);
                prop_assert!(at.position <= range_share * of.upper_rad);
                prop_assert!(at.velocity.abs() <= speed * (1.0 + ROUNDING));
                prop_assert!(at.acceleration.abs() <= acceleration * (1.0 + ROUNDING));
            }
        }
    }
}

/// Velocity and acceleration are the derivatives of the position, and both are continuous: a jump of
/// the velocity by 1e-4 rad/s, or of the acceleration by 0.1 rad/s^2, fails here.
#[test]
fn the_position_has_two_continuous_derivatives() {
    const STEP_S: f64 = 1e-4;
    let (device, bounds) = (arm(), HandMotion::default());
    let motion = Motion::new(&device, &bounds, 3).expect("a motion");
    for joint in 0..4 {
        for step in 0..200_000 {
            let time_s = 30.0 * f64::from(step) / 200_000.0;
            let [before, now, after] =
                [-STEP_S, 0.0, STEP_S].map(|shift| motion.joint_motion(joint, time_s + shift));
            let velocity = (after.position - before.position) / (2.0 * STEP_S);
            let acceleration = (after.velocity - before.velocity) / (2.0 * STEP_S);
            // jerk stays below 60 x 2 rad / (1 s)^3 or so, and 0.1 s of rests' ramps
            assert!(
                (velocity - now.velocity).abs() < 1e-5,
                "joint {joint} at {time_s}"
            );
            assert!(
                (acceleration - now.acceleration).abs() < 0.03,
                "joint {joint} at {time_s}"
            );
            assert!((after.acceleration - now.acceleration).abs() < 0.05);
        }
    }
}

#[test]
fn it_rests_at_home_at_both_ends_and_as_a_whole_in_between() {
    let (device, bounds) = (arm(), HandMotion::default());
    let motion = Motion::new(&device, &bounds, 11).expect("a motion");
    let is_still =
        |time_s: f64| (0..4).all(|joint| motion.joint_motion(joint, time_s).velocity == 0.0);
    for time_s in [-1.0, 0.0, 1.0, 2.0, 98.0, 99.0, 100.0, 101.0] {
        for joint in 0..4 {
            let at = motion.joint_motion(joint, time_s);
            assert_eq!((at.position, at.velocity, at.acceleration), (0.0, 0.0, 0.0));
        }
    }
    // three rests of 1 s, a quarter of the way apart: 26, 50 and 74 s are their middles
    for middle_s in [26.0, 50.0, 74.0] {
        assert!((0..100).all(|step| is_still(middle_s - 0.495 + 0.0099 * f64::from(step))));
        assert!(!is_still(middle_s - 0.6) && !is_still(middle_s + 0.6));
    }
    let moving = (0..1000)
        .filter(|step| !is_still(0.1 * f64::from(*step)))
        .count();
    assert!(moving > 920, "{moving}");
}

#[test]
fn a_hundred_seconds_sweep_nearly_the_whole_range_of_every_joint() {
    let (device, bounds) = (arm(), HandMotion::default());
    for seed in 1..20 {
        let motion = Motion::new(&device, &bounds, seed).expect("a motion");
        for (joint, of) in device.joints.iter().enumerate() {
            let places = || {
                (0..10_000).map(|step| motion.joint_motion(joint, 0.01 * f64::from(step)).position)
            };
            let high = places().fold(0.0, f64::max);
            let low = places().fold(0.0, f64::min);
            assert!(
                high > 0.93 * of.upper_rad && low < 0.93 * of.lower_rad,
                "joint {joint}"
            );
        }
    }
}

#[test]
fn joints_do_not_move_together() {
    let mut device = arm();
    device.joints[1] = device.joints[0].clone();
    let motion = Motion::new(&device, &HandMotion::default(), 5).expect("a motion");
    let way = |joint: usize, step: i32| motion.joint_motion(joint, 0.05 * f64::from(step)).position;
    let product: f64 = (0..2000).map(|step| way(0, step) * way(1, step)).sum();
    let square: f64 = (0..2000).map(|step| way(0, step).powi(2)).sum();
    // about 30 targets each: a correlation's standard deviation is 0.18
    assert!((product / square).abs() < 0.6, "{}", product / square);
}

#[test]
fn a_polynomial_keeps_the_joint_where_it_holds() {
    let mut device = arm();
    device.joints[2].lower_rad = -0.4;
    device.joints[2].upper_rad = 0.4;
    let motion = Motion::new(&device, &HandMotion::default(), 2).expect("a motion");
    let most =
        largest((0..10_000).map(|step| motion.joint_motion(2, 0.01 * f64::from(step)).position));
    assert!(most <= 0.095 && most > 0.09, "{most}");
}

#[test]
fn what_cannot_be_moved_is_refused() {
    let refused = |device: &Device, bounds: HandMotion| {
        Motion::new(device, &bounds, 1).expect_err("a refusal")
    };
    let short = HandMotion {
        seconds: 3.0,
        ..HandMotion::default()
    };
    let error = refused(&arm(), short);
    assert!(
        matches!(
            error,
            SimulatorError::Setting {
                setting: "seconds",
                ..
            }
        ),
        "{error}"
    );
    let hasty = HandMotion {
        ramp_s: 0.1,
        ..HandMotion::default()
    };
    let error = refused(&arm(), hasty);
    assert!(matches!(
        error,
        SimulatorError::Setting {
            setting: "acceleration",
            ..
        }
    ));
    let mut device = arm();
    device.joints[3].upper_rad = f64::INFINITY;
    let error = refused(&device, HandMotion::default());
    assert!(
        error
            .to_string()
            .contains("joint 4 (`wrist`): `upper_rad` is inf"),
        "{error}"
    );
    device.joints[3].upper_rad = -0.1;
    assert!(matches!(
        refused(&device, HandMotion::default()),
        SimulatorError::NoRoom { .. }
    ));
}

/// Share of a joint's squared speed above 2 Hz, from a discrete Fourier transform of 100 s.
#[test]
fn a_hand_has_next_to_no_motion_above_two_hertz() {
    const RATE_HZ: f64 = 20.0;
    const ROWS: i32 = 2000;
    let (device, bounds) = (arm(), HandMotion::default());
    let motion = Motion::new(&device, &bounds, 8).expect("a motion");
    for joint in 0..4 {
        let speeds: Vec<f64> = (0..ROWS)
            .map(|row| {
                motion
                    .joint_motion(joint, f64::from(row) / RATE_HZ)
                    .velocity
            })
            .collect();
        let power = |line: i32| -> f64 {
            let turn = std::f64::consts::TAU * f64::from(line) / f64::from(ROWS);
            let sums = speeds
                .iter()
                .zip(0..)
                .fold((0.0, 0.0), |(c, s), (speed, row)| {
                    let angle = turn * f64::from(row);
                    (c + speed * angle.cos(), s + speed * angle.sin())
                });
            sums.0 * sums.0 + sums.1 * sums.1
        };
        // lines are 0.01 Hz apart: 200 is 2 Hz, 1000 half the rate
        let all: f64 = (1..1000).map(power).sum();
        let fast: f64 = (200..1000).map(power).sum();
        assert!(fast / all < 2e-3, "joint {joint}: {}", fast / all);
    }
}
