//! The Chebyshev series: values, slopes, basis and the tangents outside the range.

use crate::fixture::{assert_close, difference_quotient, rows};
use haptical_transmission::chebyshev::{basis, check, contains, evaluate};
use proptest::prelude::*;

/// Roundings of a sum of 15 terms of 0.05, and of its slope, which is up to n^2 times larger.
const ROUNDING_RAD: f64 = 1e-15;
const ROUNDING_SLOPE: f64 = 1e-12;

#[test]
fn agrees_with_sixty_digit_cosines() {
    for row in rows(include_str!("../fixtures/chebyshev.csv")) {
        let n = (row.len() - 5) / 2;
        let (value_rad, slope) = evaluate([row[0], row[1]], &row[5..5 + n], row[2]);
        // The rounding of x moves a series of slope s by s eps.
        assert_close(
            value_rad,
            row[3],
            ROUNDING_RAD + f64::EPSILON * row[4].abs(),
            "value",
        );
        assert_close(slope, row[4], ROUNDING_SLOPE, "slope");
    }
}

#[test]
fn basis_is_cosines_of_multiples() {
    let range_rad = [-0.3, 0.9];
    let mut t = [0.0; 15];
    for step in 0..=40 {
        let theta_rad = -0.3 + 1.2 * f64::from(step) / 40.0;
        basis(range_rad, theta_rad, &mut t);
        let x = ((2.0 * theta_rad - 0.6) / 1.2).clamp(-1.0, 1.0);
        for (k, got) in t.into_iter().enumerate() {
            assert_close(
                got,
                (k as f64 * x.acos()).cos(),
                1e-12,
                &format!("T_{k}({x})"),
            );
        }
    }
}

#[test]
fn ends_are_met_without_rounding() {
    let range_rad = [-0.7, 1.1];
    let mut t = [0.0; 6];
    basis(range_rad, 1.1, &mut t);
    assert_eq!(t, [1.0; 6]);
    basis(range_rad, -0.7, &mut t);
    assert_eq!(t, [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
    assert!(contains(range_rad, -0.7) && contains(range_rad, 1.1));
    assert!(!contains(range_rad, -0.701) && !contains(range_rad, 1.101));
    assert!(!contains(range_rad, f64::NAN));
}

#[test]
fn tangent_of_a_known_polynomial() {
    // T_3 = 4 x^3 - 3 x has slope 9 at both ends; x = 2 theta
    let range_rad = [-0.5, 0.5];
    let (value_rad, slope) = evaluate(range_rad, &[0.0, 0.0, 0.0, 1.0], 0.6);
    assert_close(value_rad, 1.0 + 9.0 * 0.2, 1e-14, "beyond the upper end");
    assert_close(slope, 18.0, 1e-13, "slope beyond the upper end");
    let (value_rad, slope) = evaluate(range_rad, &[0.0, 0.0, 1.0], -0.6);
    // T_2 has slope -4 at x = -1
    assert_close(value_rad, 1.0 + 4.0 * 0.2, 1e-14, "beyond the lower end");
    assert_close(slope, -8.0, 1e-13, "slope beyond the lower end");
}

#[test]
fn short_series() {
    assert_eq!(evaluate([-1.0, 1.0], &[], 0.5), (0.0, 0.0));
    assert_eq!(evaluate([-1.0, 1.0], &[0.25], 7.0), (0.25, 0.0));
    assert_eq!(evaluate([-1.0, 1.0], &[0.25, 2.0], 3.0), (6.25, 2.0));
    basis([-1.0, 1.0], 0.5, &mut []);
}

#[test]
fn unchecked_bad_arguments_are_visible() {
    assert!(check([0.5, 0.5], &[1.0]).is_err());
    assert!(check([-0.5, f64::INFINITY], &[1.0]).is_err());
    assert!(check([-0.5, 0.5], &[1.0, f64::NAN]).is_err());
    assert!(check([-0.5, 0.5], &[1.0]).is_ok());
    for range_rad in [
        [0.5, 0.5],
        [1.0, -1.0],
        [f64::NAN, 1.0],
        [-1.0, f64::INFINITY],
    ] {
        let mut t = [0.0; 3];
        basis(range_rad, 0.2, &mut t);
        assert!(
            t[1].is_nan() && evaluate(range_rad, &[1.0, 1.0], 0.2).0.is_nan(),
            "{range_rad:?}"
        );
    }
    assert!(evaluate([-1.0, 1.0], &[1.0, 1.0], f64::NAN).0.is_nan());
}

prop_compose! {
    fn series()(
        centre in -1.0..1.0f64, half in 0.05..2.0f64,
        coefficients in prop::collection::vec(-0.05..0.05f64, 1..16),
    ) -> ([f64; 2], Vec<f64>) {
        ([centre - half, centre + half], coefficients)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Inside and outside, the series is the sum over the basis.
    #[test]
    fn series_is_the_sum_over_the_basis((range_rad, c) in series(), x in -3.0..3.0f64) {
        let theta_rad = 0.5 * (range_rad[0] + range_rad[1]) + 0.5 * x * (range_rad[1] - range_rad[0]);
        let mut t = [0.0; 16];
        basis(range_rad, theta_rad, &mut t);
        let sum: f64 = c.iter().zip(t).map(|(c, t)| c * t).sum();
        let (value_rad, _) = evaluate(range_rad, &c, theta_rad);
        prop_assert!((value_rad - sum).abs() < 1e-11, "{value_rad} vs {sum}");
    }

    /// Value and slope have no jump at an end, and the slope outside is constant.
    #[test]
    fn tangents_continue_value_and_slope((range_rad, c) in series()) {
        let width_rad = range_rad[1] - range_rad[0];
        for (end_rad, outwards) in [(range_rad[0], -1.0), (range_rad[1], 1.0)] {
            let nudge_rad = 1e-9 * width_rad * outwards;
            let (inside_rad, inside_slope) = evaluate(range_rad, &c, end_rad - nudge_rad);
            let (end_value_rad, end_slope) = evaluate(range_rad, &c, end_rad);
            let (outside_rad, outside_slope) = evaluate(range_rad, &c, end_rad + nudge_rad);
            // second derivative at an end: at most c n^4 / 3 over the half width squared
            prop_assert!((inside_slope - end_slope).abs() * width_rad < 1e-4);
            prop_assert!((outside_slope - end_slope).abs() * width_rad < 1e-9);
            prop_assert!((inside_rad - end_value_rad).abs() < 1e-6);
            prop_assert!((outside_rad - end_value_rad).abs() < 1e-6);
            let (far_rad, far_slope) = evaluate(range_rad, &c, end_rad + 50.0 * outwards);
            prop_assert!((far_slope - end_slope).abs() * width_rad < 1e-9);
            let line_rad = end_value_rad + 50.0 * outwards * end_slope;
            prop_assert!((far_rad - line_rad).abs() < 1e-10 * (1.0 + line_rad.abs()) / width_rad);
        }
    }

    #[test]
    fn slope_is_a_difference_quotient((range_rad, c) in series(), x in -2.0..2.0f64) {
        let half_rad = 0.5 * (range_rad[1] - range_rad[0]);
        let theta_rad = range_rad[0] + half_rad * (1.0 + x);
        prop_assume!((x.abs() - 1.0).abs() > 1e-4);
        let (_, slope) = evaluate(range_rad, &c, theta_rad);
        let value = |t| evaluate(range_rad, &c, t).0;
        let quotient = difference_quotient(value, theta_rad, 1e-6 * half_rad);
        prop_assert!((slope - quotient).abs() * half_rad < 1e-6, "{slope} vs {quotient}");
    }
}
