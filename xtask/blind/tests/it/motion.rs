//! Motions: rates are derivatives, ends are at home, limits hold, the whole range is used.

use xtask_blind::{Motion, MotionPlan, NOMINALS, Random};

fn motion(plan: &MotionPlan, seed: u64) -> (Motion, Vec<[f64; 2]>) {
    let device = NOMINALS[0].device().expect("a device");
    let limits = device
        .joints
        .iter()
        .map(|joint| [joint.lower_rad, joint.upper_rad])
        .collect();
    (
        Motion::draw(&device, plan, &mut Random::new(seed, 0)),
        limits,
    )
}

#[test]
fn rates_and_accelerations_are_derivatives() {
    // at 1000 Hz central differences of motions of 1 Hz are good to 1e-4 of the largest rate; at
    // the spline's knots the third derivative jumps, which costs the second difference a little more
    const RATE_TOLERANCE: f64 = 2e-4;
    const ACCELERATION_TOLERANCE: f64 = 0.02;
    let plan = MotionPlan {
        rows: 20_000,
        rate_hz: 1000.0,
        ..MotionPlan::default()
    };
    let (motion, _) = motion(&plan, 4);
    for joint in 0..motion.angle_rad.len() {
        let (angle, rate) = (&motion.angle_rad[joint], &motion.rate_rad_s[joint]);
        let acceleration = &motion.acceleration_rad_s2[joint];
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let (rate_tolerance, acceleration_tolerance) = (
            RATE_TOLERANCE * largest(rate),
            ACCELERATION_TOLERANCE * largest(acceleration),
        );
        for row in 1..motion.len() - 1 {
            let slope = (angle[row + 1] - angle[row - 1]) * 500.0;
            assert!((slope - rate[row]).abs() < rate_tolerance, "row {row}");
            let slope = (rate[row + 1] - rate[row - 1]) * 500.0;
            let error = (slope - acceleration[row]).abs();
            assert!(error < acceleration_tolerance, "row {row}: {error}");
        }
    }
}

#[test]
fn recordings_start_and_end_at_home_and_fill_the_range() {
    let plan = MotionPlan::default();
    for seed in 0..5 {
        let (motion, limits) = motion(&plan, seed);
        assert_eq!(motion.len(), 6000);
        let mut reversals = 0;
        for (joint, [lower, upper]) in limits.iter().enumerate() {
            let angle = &motion.angle_rad[joint];
            assert!(
                angle[..150].iter().all(|angle| *angle == 0.0),
                "rest at the start"
            );
            assert!(
                angle[5950..].iter().all(|angle| *angle == 0.0),
                "rest at the end"
            );
            let (low, high) = angle.iter().fold((0.0_f64, 0.0_f64), |(low, high), angle| {
                (low.min(*angle), high.max(*angle))
            });
            assert!(
                low >= *lower && high <= *upper,
                "joint {joint}: {low} to {high}"
            );
            assert!(
                high - low > 0.55 * (upper - lower),
                "joint {joint}: {low} to {high}"
            );
            let rate = &motion.rate_rad_s[joint];
            reversals += rate
                .windows(2)
                .filter(|pair| pair[0] * pair[1] < 0.0)
                .count();
        }
        let mean = reversals as f64 / limits.len() as f64;
        assert!((20.0..60.0).contains(&mean), "{mean} reversals per joint");
    }
}

#[test]
fn runs_follow_each_other_and_each_rests_at_home() {
    let plan = MotionPlan {
        rows: 2000,
        runs: 2,
        ..MotionPlan::default()
    };
    let (motion, _) = motion(&plan, 9);
    assert_eq!(motion.len(), 4000);
    assert_eq!((motion.run[1999], motion.run[2000]), (0, 1));
    assert_eq!(motion.time_s[2000], 0.0);
    for angle in &motion.angle_rad {
        assert!(angle[1990..2100].iter().all(|angle| *angle == 0.0));
    }
}

/// The same seed gives the same motion whatever the reach: only its size changes.
#[test]
fn pace_makes_a_motion_slower() {
    let slow = MotionPlan {
        pace_s: 2.7,
        ..MotionPlan::default()
    };
    let speed = |plan: &MotionPlan| {
        let (motion, _) = motion(plan, 3);
        let squares: f64 = motion
            .rate_rad_s
            .iter()
            .flatten()
            .map(|rate| rate * rate)
            .sum();
        squares.sqrt()
    };
    assert!(speed(&slow) < 0.6 * speed(&MotionPlan::default()));
}
