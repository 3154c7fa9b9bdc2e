//! Sine, cosine and arctangent against the standard library's.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use haptical_kinematics::trigonometry::{LARGEST_RAD, arctangent2, sine_cosine};
use proptest::prelude::*;

/// The polynomials' bound and the rounding of two operations at 1; the library's own half ulp.
const SINE_TOLERANCE: f64 = 2.3e-16;
/// One ulp of an angle in [2, pi].
const ANGLE_TOLERANCE: f64 = 4.5e-16;

fn sine_and_cosine_are_right(angle_rad: f64) {
    let (sine, cosine) = sine_cosine(angle_rad);
    assert!(
        (sine - angle_rad.sin()).abs() <= SINE_TOLERANCE,
        "{angle_rad}"
    );
    assert!(
        (cosine - angle_rad.cos()).abs() <= SINE_TOLERANCE,
        "{angle_rad}"
    );
}

#[test]
fn sines_at_and_beside_every_eighth_of_a_turn_and_at_the_ends() {
    for eighth in -80_i32..=80 {
        let angle_rad = f64::from(eighth) * FRAC_PI_4;
        for angle_rad in [angle_rad, angle_rad.next_up(), angle_rad.next_down()] {
            sine_and_cosine_are_right(angle_rad);
        }
    }
    for angle_rad in [0.0, 1e-300, 1e-8, 1e5, LARGEST_RAD, -LARGEST_RAD] {
        sine_and_cosine_are_right(angle_rad);
    }
    assert_eq!(sine_cosine(0.0), (0.0, 1.0));
}

#[test]
fn sines_at_multiples_of_half_a_turn_up_to_the_largest_angle() {
    // the reduction is worst where almost nothing is left
    for multiple in (0_i32..318_000).step_by(97) {
        sine_and_cosine_are_right(f64::from(multiple) * PI);
    }
}

#[test]
fn a_million_sines() {
    for step in -500_000_i32..500_000 {
        sine_and_cosine_are_right(f64::from(step) * 3.3e-5);
    }
}

#[test]
fn angles_that_are_not_finite_or_much_too_large_do_not_panic() {
    for angle_rad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(sine_cosine(angle_rad).0.is_nan());
    }
    assert!(sine_cosine(1e15).0.is_finite());
    let _ = sine_cosine(f64::MAX);
}

#[test]
fn arctangents_of_all_directions() {
    for step in -100_000_i32..=100_000 {
        let direction_rad = f64::from(step) * (PI / 100_000.0);
        let (y, x) = direction_rad.sin_cos();
        let found = arctangent2(y, x);
        assert!((found - y.atan2(x)).abs() <= ANGLE_TOLERANCE, "{y} {x}");
    }
    assert_eq!(arctangent2(0.0, 2.0), 0.0);
    assert_eq!(arctangent2(3.0, 0.0), FRAC_PI_2);
    assert_eq!(arctangent2(-3.0, 0.0), -FRAC_PI_2);
}

proptest! {
    #[test]
    fn sines_of_any_angle(angle_rad in -LARGEST_RAD..LARGEST_RAD) {
        sine_and_cosine_are_right(angle_rad);
    }

    #[test]
    fn arctangents_of_any_point(y in -1e3..1e3_f64, x in -1e3..1e3_f64, scale in -30..30_i32) {
        let x = x * 2f64.powi(scale);
        prop_assert!((arctangent2(y, x) - y.atan2(x)).abs() <= ANGLE_TOLERANCE);
    }

    #[test]
    fn a_small_arctangent_keeps_its_relative_digits(t in -0.4..0.4_f64, exponent in -300..0_i32) {
        let y = t * 2f64.powi(exponent);
        let expected = y.atan();
        prop_assert!((arctangent2(y, 1.0) - expected).abs() <= 2.0 * f64::EPSILON * expected.abs());
    }
}
