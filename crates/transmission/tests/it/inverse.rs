//! The inverse: identity with the forward law, refusals, hard functions.

use crate::fixture::assert_close;
use core::cell::Cell;
use haptical_transmission::{
    Capstan, CapstanError, CapstanParallelogram, LawError, Parallelogram, chebyshev, invert,
};
use proptest::prelude::*;

/// What the inverse promises, rad.
const PROMISED_RAD: f64 = 1e-12;

#[test]
fn line_by_hand() {
    // theta + (0.25 theta + 0.1) = 0.6
    let line = |theta: f64| Ok((0.25 * theta + 0.1, 0.25));
    assert_close(
        invert(line, 0.6, [-1.0, 1.0]).unwrap(),
        0.4,
        PROMISED_RAD,
        "line",
    );
}

#[test]
fn an_end_of_the_bracket_may_be_the_answer() {
    let none = |_: f64| Ok((0.0, 0.0));
    for output_rad in [-1.0, 1.0, 0.0] {
        assert_eq!(invert(none, output_rad, [-1.0, 1.0]), Ok(output_rad));
    }
}

#[test]
fn newton_that_would_run_away_is_held() {
    // output = atan(50 theta): from the ends Newton's step overshoots by far
    let steep = |t: f64| Ok(((50.0 * t).atan() - t, 50.0 / (1.0 + 2500.0 * t * t) - 1.0));
    for want_rad in [-0.9f64, -0.3, 1e-4, 0.02, 0.7] {
        let got_rad = invert(steep, (50.0 * want_rad).atan(), [-1.0, 1.0]).unwrap();
        // the slope there is as small as 0.02, which multiplies the rounding of the output
        assert_close(got_rad, want_rad, PROMISED_RAD, "steep");
    }
}

#[test]
fn few_evaluations_for_a_small_error() {
    let calls = Cell::new(0);
    let ripple = |t: f64| {
        calls.set(calls.get() + 1);
        Ok((0.01 * (8.0 * t).sin(), 0.08 * (8.0 * t).cos()))
    };
    invert(ripple, 0.123, [-1.6, 1.6]).unwrap();
    // two ends, eight checks, and Newton's steps
    assert!(calls.get() <= 16, "{} evaluations", calls.get());
}

#[test]
fn angles_far_from_zero_stop_at_the_spacing_of_numbers() {
    let wave = |theta: f64| Ok((0.1 * theta.sin(), 0.1 * theta.cos()));
    for step in 0..500 {
        let output_rad = 1e6 - 3.0 + 0.0123 * f64::from(step);
        let theta_rad = invert(wave, output_rad, [1e6 - 5.0, 1e6 + 5.0]).unwrap();
        assert_close(
            theta_rad + 0.1 * theta_rad.sin(),
            output_rad,
            1e-9,
            "at a million rad",
        );
    }
}

#[test]
fn an_output_outside_the_bracket_is_refused() {
    let line = |theta: f64| Ok((theta, 1.0));
    for output_rad in [2.5, -2.5] {
        assert_eq!(
            invert(line, output_rad, [-1.0, 1.0]),
            Err(LawError::NotBracketed {
                output_rad,
                bracket_rad: [-1.0, 1.0],
                reached_rad: [-2.0, 2.0]
            })
        );
    }
}

#[test]
fn an_output_that_turns_back_is_refused() {
    let reversed = |theta: f64| Ok((-3.0 * theta, -3.0));
    let flat = |theta: f64| Ok((-theta, -1.0));
    let folded = |t: f64| Ok((0.5 * (5.0 * t).sin(), 2.5 * (5.0 * t).cos()));
    let jump = |t: f64| Ok((if t > 0.3 { -1.0 } else { 0.0 }, 0.0));
    let refused = |result| matches!(result, Err(LawError::NotMonotone { .. }));
    assert!(refused(invert(reversed, 0.1, [-1.0, 1.0])));
    assert!(refused(invert(flat, 0.0, [-1.0, 1.0])));
    assert!(refused(invert(folded, 0.1, [-0.9, 0.9])));
    assert!(refused(invert(jump, 0.1, [-1.0, 1.0])));
}

#[test]
fn bad_arguments_and_errors_of_the_law_are_passed_on() {
    let none = |_: f64| Ok((0.0, 0.0));
    assert!(matches!(
        invert(none, f64::NAN, [-1.0, 1.0]),
        Err(LawError::NonFinite { .. })
    ));
    for bracket_rad in [
        [1.0, -1.0],
        [0.0, 0.0],
        [f64::NAN, 1.0],
        [-1.0, f64::INFINITY],
    ] {
        let result = invert(none, 0.0, bracket_rad);
        assert!(
            matches!(result, Err(LawError::InvalidRange { .. })),
            "{bracket_rad:?}"
        );
    }
    let not_a_number = |_: f64| Ok((f64::NAN, 0.0));
    let result = invert(not_a_number, 0.0, [-1.0, 1.0]);
    assert!(matches!(result, Err(LawError::NonFinite { .. })));
    let joint = CapstanParallelogram {
        capstan: Capstan::new(12.0, 0.1, 0.1).unwrap(),
        parallelogram: Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap(),
    };
    let result = joint.invert(&CapstanError::default(), &[0.0; 4], 0.1, [-2.0, 2.0]);
    assert!(matches!(result, Err(LawError::SingularLoop { .. })));
}

prop_compose! {
    /// A drive whose drums turn the output by less than the encoder does.
    fn drive_and_error()(
        ratio in prop_oneof![2.0..20.0, -20.0..-2.0],
        distance_m in 0.03..0.15,
        denominator_m in 0.002..0.15,
        offset_rad in -0.02..0.02,
        deviation in -0.1..0.1,
        polar in [0.0..0.2, -3.2..3.2, 0.0..0.4, -3.2..3.2f64],
    ) -> (Capstan, CapstanError) {
        let [r_o, beta_o, r_i, beta_i] = polar;
        let input_m = r_i * denominator_m / f64::abs(ratio);
        let drive = Capstan::new(ratio, distance_m, denominator_m).unwrap();
        let p = CapstanError::from_polar(
            offset_rad, deviation * ratio, r_o * distance_m, beta_o, input_m, beta_i,
        );
        (drive, p)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn capstan_round_trip((drive, p) in drive_and_error(), theta in -2.0..2.0f64) {
        let output_rad = theta + drive.error(&p, theta).unwrap();
        let back_rad = drive.invert(&p, output_rad, [-2.5, 2.5]).unwrap();
        prop_assert!((back_rad - theta).abs() <= PROMISED_RAD, "{}", back_rad - theta);
    }

    #[test]
    fn capstan_parallelogram_round_trip(
        (capstan, p) in drive_and_error(),
        deviations_m in prop::array::uniform4(-0.001..0.001f64),
        theta in -0.75..0.75f64,
    ) {
        // A quarter of the drawn drive's errors moves the loop to 1 rad at most, where it still closes.
        let p = CapstanError::from_array(p.to_array().map(|value| 0.25 * value));
        let parallelogram = Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap();
        let joint = CapstanParallelogram { capstan, parallelogram };
        let output_rad = theta + joint.error(&p, &deviations_m, theta).unwrap();
        let back_rad = joint.invert(&p, &deviations_m, output_rad, [-0.8, 0.8]).unwrap();
        prop_assert!((back_rad - theta).abs() <= PROMISED_RAD, "{}", back_rad - theta);
    }

    #[test]
    fn chebyshev_round_trip(draws in prop::array::uniform11(-1.0..1.0f64), theta in -1.2..1.2f64) {
        let range_rad = [-0.8, 0.7];
        // |T_k'| <= k^2 over the half width of 0.75: the slope of the error stays below 0.7
        let weights = 1.0 + (1..=10).map(|k| f64::from(k * k)).sum::<f64>();
        let coefficients = draws.map(|draw| 0.5 * draw / weights);
        let (error_rad, _) = chebyshev::evaluate(range_rad, &coefficients, theta);
        let error = |angle_rad| Ok(chebyshev::evaluate(range_rad, &coefficients, angle_rad));
        let back_rad = invert(error, theta + error_rad, [-1.3, 1.3]).unwrap();
        prop_assert!((back_rad - theta).abs() <= PROMISED_RAD, "{}", back_rad - theta);
    }
}
