//! The capstan's error, slope and derivatives against 60-digit numbers and difference quotients.

use crate::fixture::{assert_all_close, assert_close, difference_quotient, rows, take};
use haptical_transmission::{Capstan, CapstanError};
use proptest::prelude::*;

/// Roundings of a result of order 1; the fixture has drums displaced by nine tenths of `D`, which
/// multiply them by ten.
const RELATIVE: f64 = 1e-13;

#[test]
fn agrees_with_sixty_digit_numbers() {
    for row in rows(include_str!("../fixtures/capstan.csv")) {
        let [ratio, distance_m, denominator_m] = take(&row, 0);
        let drive = Capstan::new(ratio, distance_m, denominator_m).unwrap();
        let p = CapstanError::from_array(take(&row, 3));
        let all = drive.evaluate(&p, row[9]).unwrap();
        assert_close(all.value_rad, row[10], RELATIVE, "value");
        assert_close(all.slope, row[11], RELATIVE * ratio.abs(), "slope");
        // A derivative with respect to an eccentricity is a difference of two terms of size 1 / D.
        let smallest = 1.0 / denominator_m;
        assert_all_close(
            &all.derivatives,
            &take::<6>(&row, 12),
            RELATIVE,
            smallest,
            "derivatives",
        );
        assert_eq!(drive.error(&p, row[9]).unwrap(), all.value_rad);
    }
}

prop_compose! {
    /// A drive with drum eccentricities up to a fifth of their denominators.
    fn drive_and_error()(
        ratio in prop_oneof![2.0..20.0, -20.0..-2.0],
        distance_m in 0.03..0.15,
        denominator_m in 0.002..0.15,
        offset_rad in -0.02..0.02,
        deviation in -0.1..0.1,
        polar in [0.0..0.2, -3.2..3.2, 0.0..0.2, -3.2..3.2f64],
    ) -> (Capstan, CapstanError) {
        let [r_o, beta_o, r_i, beta_i] = polar;
        let drive = Capstan::new(ratio, distance_m, denominator_m).unwrap();
        let p = CapstanError::from_polar(
            offset_rad, deviation * ratio, r_o * distance_m, beta_o, r_i * denominator_m, beta_i,
        );
        (drive, p)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Truncation of the quotients: (step R)^2 for the slope, (step / D)^2 for the parameters.
    #[test]
    fn derivatives_are_difference_quotients((drive, p) in drive_and_error(), theta in -2.0..2.0f64) {
        let all = drive.evaluate(&p, theta).unwrap();
        let slope = difference_quotient(|t| drive.error(&p, t).unwrap(), theta, 1e-6);
        prop_assert!((slope - all.slope).abs() < 1e-7, "slope {} vs {slope}", all.slope);
        let lengths_m = [drive.drum_distance_m(), drive.input_drum_denominator_m()];
        let sizes =
            [1.0, drive.transmission_ratio(), lengths_m[0], lengths_m[0], lengths_m[1], lengths_m[1]];
        for (index, size) in sizes.into_iter().enumerate() {
            let moved = |value: f64| {
                let mut parameters = p.to_array();
                parameters[index] = value;
                drive.error(&CapstanError::from_array(parameters), theta).unwrap()
            };
            let quotient = difference_quotient(moved, p.to_array()[index], 1e-6 * size);
            let scaled = (quotient - all.derivatives[index]) * size;
            prop_assert!(scaled.abs() < 1e-8, "{}: off by {scaled}", CapstanError::PARAMETER_NAMES[index]);
        }
    }

    /// The two eccentricity terms are periodic in their own drum's turn.
    #[test]
    fn drums_repeat_after_a_turn((drive, p) in drive_and_error(), theta in -2.0..2.0f64) {
        let turn = core::f64::consts::TAU;
        let mut output_only = p;
        output_only.ratio_deviation = 0.0;
        output_only.input_drum_xy_m = [0.0; 2];
        let mut input_only = p;
        input_only.ratio_deviation = 0.0;
        input_only.output_drum_xy_m = [0.0; 2];
        for (q, period) in [(output_only, turn), (input_only, turn / drive.transmission_ratio())] {
            let gap = drive.error(&q, theta).unwrap() - drive.error(&q, theta + period).unwrap();
            prop_assert!(gap.abs() < 1e-12, "period {period}: {gap}");
        }
    }
}
