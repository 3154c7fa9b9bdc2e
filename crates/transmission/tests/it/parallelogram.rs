//! The parallelogram's error against 60-digit numbers, the acos form and its first-order law.

use crate::fixture::{assert_all_close, assert_close, difference_quotient, rows, take};
use haptical_transmission::Parallelogram;
use proptest::prelude::*;

/// Roundings of angles of order 1.
const ROUNDING_RAD: f64 = 2e-15;

/// Roundings of a loop of any proportions drawn here: `gamma` depends on `L4 + s - L3`, which is as
/// little as a fiftieth of the bars it is the difference of.
const DRAWN_LOOP_RAD: f64 = 50.0 * f64::EPSILON;

/// Roundings of derivatives, over the size 1 / L4 of their terms.
const RELATIVE: f64 = 1e-13;

/// The two acos of the cosine law, home taken off: eq. (2) as it was meant.
fn acos_form(lengths_m: [f64; 4], theta_a_rad: f64) -> f64 {
    let [l1, l2, l3, l4] = lengths_m;
    let interior = |theta: f64| {
        let angle = core::f64::consts::FRAC_PI_2 - theta;
        let s = (l1 * l1 + l2 * l2 - 2.0 * l1 * l2 * angle.cos()).sqrt();
        ((l1 * l1 + s * s - l2 * l2) / (2.0 * l1 * s)).acos()
            + ((l4 * l4 + s * s - l3 * l3) / (2.0 * l4 * s)).acos()
    };
    interior(theta_a_rad) - interior(0.0) - theta_a_rad
}

#[test]
fn agrees_with_sixty_digit_numbers() {
    for row in rows(include_str!("../fixtures/parallelogram.csv")) {
        let joint = Parallelogram::new(take(&row, 0)).unwrap();
        let all = joint.evaluate(&take(&row, 4), row[8]).unwrap();
        assert_close(all.value_rad, row[9], ROUNDING_RAD, "value");
        assert_close(all.slope, row[10], RELATIVE, "slope");
        let smallest = 1.0 / row[3];
        assert_all_close(
            &all.derivatives,
            &take::<4>(&row, 11),
            RELATIVE,
            smallest,
            "derivatives",
        );
        let mut lengths_m: [f64; 4] = take(&row, 0);
        lengths_m
            .iter_mut()
            .zip(&row[4..8])
            .for_each(|(l, d)| *l += d);
        assert_close(acos_form(lengths_m, row[8]), row[9], 1e-14, "acos form");
    }
}

#[test]
fn nearly_stretched_loops_lose_no_more_digits_than_the_acos_form() {
    let (mut ours_rad, mut acos_rad) = (0.0f64, 0.0f64);
    for row in rows(include_str!("../fixtures/parallelogram_near_singular.csv")) {
        let lengths_m: [f64; 4] = take(&row, 0);
        let (theta_rad, want_rad) = (row[4], row[5]);
        let got_rad = Parallelogram::new(lengths_m)
            .unwrap()
            .error(&[0.0; 4], theta_rad)
            .unwrap();
        // The triangle's inequality holds by an excess that s leaves with a rounding of eps s; the
        // angle is as the square root of the excess.
        let excess = (lengths_m[2] + lengths_m[3]) / lengths_m[0].hypot(lengths_m[1]) - 1.0;
        let floor_rad = 4.0 * f64::EPSILON / excess.sqrt();
        assert_close(got_rad, want_rad, floor_rad, "nearly stretched");
        ours_rad = ours_rad.max((got_rad - want_rad).abs());
        acos_rad = acos_rad.max((acos_form(lengths_m, theta_rad) - want_rad).abs());
    }
    assert!(
        ours_rad <= acos_rad,
        "atan2 form {ours_rad:e}, acos form {acos_rad:e}"
    );
}

prop_compose! {
    /// Long side and crank of a parallelogram, four deviations of up to 1 mm, an angle. Every triangle
    /// inequality of the nominal loop holds by 8 mm within 0.8 rad, so each loop drawn closes.
    fn loop_and_angle()(
        long_m in 0.1..0.3, crank_m in 0.04..0.09, deviations_m in prop::array::uniform4(-0.001..0.001f64),
        theta_rad in -0.8..0.8f64,
    ) -> (Parallelogram, [f64; 4], f64) {
        let joint = Parallelogram::new([long_m, crank_m, long_m, crank_m]).unwrap();
        (joint, deviations_m, theta_rad)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn parallelogram_without_deviations_has_no_error((joint, _, theta_rad) in loop_and_angle()) {
        let all = joint.evaluate(&[0.0; 4], theta_rad).unwrap();
        prop_assert!(all.value_rad.abs() <= DRAWN_LOOP_RAD, "{}", all.value_rad);
        prop_assert!(all.slope.abs() <= RELATIVE, "{}", all.slope);
    }

    #[test]
    fn scaling_all_bars_changes_nothing((joint, deviations_m, theta_rad) in loop_and_angle()) {
        let value_rad = joint.error(&deviations_m, theta_rad).unwrap();
        for factor in [1e-200, 25.4, 1e200] {
            let scaled = Parallelogram::new(joint.lengths_m().map(|l| l * factor)).unwrap();
            let again_rad = scaled.error(&deviations_m.map(|d| d * factor), theta_rad).unwrap();
            prop_assert!((again_rad - value_rad).abs() <= 2.0 * DRAWN_LOOP_RAD);
        }
    }

    #[test]
    fn first_order_sensitivities((joint, _, theta_rad) in loop_and_angle()) {
        // [(dL3 - dL1) (1 / cos - 1) + (dL2 - dL4) tan] / L4
        let derivatives = joint.evaluate(&[0.0; 4], theta_rad).unwrap().derivatives;
        let crank_m = joint.lengths_m()[3];
        let sec = (1.0 / theta_rad.cos() - 1.0) / crank_m;
        let tan = theta_rad.tan() / crank_m;
        for (got, want) in derivatives.into_iter().zip([-sec, tan, sec, -tan]) {
            prop_assert!((got - want).abs() * crank_m <= RELATIVE * 10.0, "{got} vs {want}");
        }
    }

    #[test]
    fn derivatives_are_difference_quotients((joint, deviations_m, theta_rad) in loop_and_angle()) {
        let all = joint.evaluate(&deviations_m, theta_rad).unwrap();
        let slope = difference_quotient(|t| joint.error(&deviations_m, t).unwrap(), theta_rad, 1e-6);
        prop_assert!((slope - all.slope).abs() < 1e-8, "slope {} vs {slope}", all.slope);
        for index in 0..4 {
            let moved = |value: f64| {
                let mut moved_m = deviations_m;
                moved_m[index] = value;
                joint.error(&moved_m, theta_rad).unwrap()
            };
            let quotient = difference_quotient(moved, deviations_m[index], 1e-7);
            let got = all.derivatives[index];
            prop_assert!((quotient - got).abs() < 1e-6, "length {index}: {got} vs {quotient}");
        }
    }
}
