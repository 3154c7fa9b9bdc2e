//! Improvements against the values printed in the paper and closed forms.

use haptical_metrics::{
    MetricsError, gap_reduction_percent, parameter_improvement_percent, rms,
    rms_improvement_percent,
};
use proptest::prelude::*;

/// Rounding of a handful of operations on numbers near 100.
const PERCENT_ROUNDING: f64 = 1e-11;
/// Printed with two decimals from values with more digits than the paper prints.
const PRINTED_PERCENT: f64 = 0.15;
/// Rounding of a sum of squares and a square root, relative.
const RELATIVE_ROUNDING: f64 = 1e-14;

#[test]
fn parameter_improvement_matches_table_3() {
    // Link twists 1 to 6, mrad, printed percentages in the last place of each triple.
    let rows = [
        (-1.5, -1.477, 98.47),
        (1.3, 1.309, 99.30),
        (-1.4, -1.396, 99.73),
        (1.2, 1.424, 81.35),
        (-1.1, -1.320, 80.01),
        (-1.6, -1.546, 96.60),
    ];
    for (assigned, identified, printed) in rows {
        let percent = parameter_improvement_percent(assigned, identified, 0.0).unwrap();
        assert!(
            (percent - printed).abs() < PRINTED_PERCENT,
            "{assigned}: {percent} / {printed}"
        );
    }
    let percent = parameter_improvement_percent(1.2, 1.424, 0.0).unwrap();
    assert!(
        (percent - (100.0 - 22.4 / 1.2)).abs() < PERCENT_ROUNDING,
        "{percent}"
    );
}

#[test]
fn parameter_improvement_uses_the_nominal_value() {
    let percent = parameter_improvement_percent(10.0, 11.0, 6.0).unwrap();
    assert!((percent - 75.0).abs() < PERCENT_ROUNDING);
    let worse = parameter_improvement_percent(10.0, 18.0, 6.0).unwrap();
    assert!((worse + 100.0).abs() < PERCENT_ROUNDING);
}

#[test]
fn parameter_improvement_refuses_what_has_no_answer() {
    let equal = parameter_improvement_percent(1.5, 1.4, 1.5).unwrap_err();
    assert_eq!(equal, MetricsError::ActualEqualsNominal { value: 1.5 });
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(parameter_improvement_percent(bad, 0.0, 1.0).is_err());
        assert!(parameter_improvement_percent(0.0, bad, 1.0).is_err());
        assert!(parameter_improvement_percent(0.0, 1.0, bad).is_err());
    }
    let overflow = parameter_improvement_percent(0.0, 1e300, 1e-300).unwrap_err();
    assert!(
        matches!(overflow, MetricsError::Overflow { .. }),
        "{overflow}"
    );
}

#[test]
fn rms_of_a_sine_over_whole_periods_is_its_amplitude_over_root_two() {
    let samples: Vec<f64> = (0..1000)
        .map(|k| 3.0 * (std::f64::consts::TAU * f64::from(k) / 1000.0).sin())
        .collect();
    let value = rms(&samples).unwrap();
    assert!(
        (value - 3.0 / std::f64::consts::SQRT_2).abs() < 3.0 * RELATIVE_ROUNDING,
        "{value}"
    );
}

#[test]
fn rms_holds_at_the_ends_of_the_number_range_and_refuses_nonsense() {
    let large = rms(&[1e300, -1e300]).unwrap();
    assert!((large / 1e300 - 1.0).abs() < RELATIVE_ROUNDING);
    let small = rms(&[1e-300, 1e-300]).unwrap();
    assert!((small / 1e-300 - 1.0).abs() < RELATIVE_ROUNDING);
    assert_eq!(rms(&[0.0, -0.0]).unwrap(), 0.0);
    assert!(matches!(
        rms(&[]),
        Err(MetricsError::TooFew {
            got: 0,
            needed: 1,
            ..
        })
    ));
    let nan = rms(&[1.0, 2.0, f64::NAN]).unwrap_err();
    assert!(
        matches!(nan, MetricsError::NonFinite { index: 2, .. }),
        "{nan}"
    );
}

#[test]
fn rms_improvement_keeps_the_printed_magnitude_and_says_the_direction() {
    let better = rms_improvement_percent(10.0, 0.34).unwrap();
    assert!((better.percent_as_printed - 96.6).abs() < PERCENT_ROUNDING && !better.worse);
    let worse = rms_improvement_percent(10.0, 12.0).unwrap();
    assert!((worse.percent_as_printed - 20.0).abs() < PERCENT_ROUNDING && worse.worse);
    assert!(!rms_improvement_percent(1.0, 1.0).unwrap().worse);
    assert!(rms_improvement_percent(0.0, 1.0).is_err());
    assert!(rms_improvement_percent(1.0, -1.0).is_err());
    let text = serde_json::to_string(&worse).unwrap();
    assert!(
        text.contains("percent_as_printed") && text.contains("\"worse\":true"),
        "{text}"
    );
}

#[test]
fn gap_reduction_takes_the_noise_out() {
    // before^2 - floor^2 = 0.75^2 and after^2 - floor^2 = 0.15^2: a fifth of the gap is left.
    let floor = 1.0_f64;
    let (before, after) = (1.5625_f64.sqrt(), 1.0225_f64.sqrt());
    let percent = gap_reduction_percent(before, after, floor).unwrap();
    assert!((percent - 80.0).abs() < PERCENT_ROUNDING, "{percent}");
    assert_eq!(gap_reduction_percent(2.0, 0.9, 1.0), Some(100.0));
    assert_eq!(gap_reduction_percent(2.0, 2.0, 1.0), Some(0.0));
    assert!(gap_reduction_percent(2.0, 3.0, 1.0).unwrap() < 0.0);
    assert_eq!(gap_reduction_percent(1.0, 0.5, 1.0), None);
    assert_eq!(gap_reduction_percent(0.0, 0.0, 0.0), None);
    assert_eq!(gap_reduction_percent(f64::NAN, 1.0, 0.5), None);
    assert_eq!(gap_reduction_percent(2.0, 1.0, -0.5), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn parameter_improvement_does_not_depend_on_unit_or_origin(
        actual in -10.0..10.0_f64, estimated in -10.0..10.0_f64, away in 0.1..5.0_f64,
        scale in 0.5..2000.0_f64,
    ) {
        let nominal = actual + away;
        let plain = parameter_improvement_percent(actual, estimated, nominal).unwrap();
        let scaled =
            parameter_improvement_percent(actual * scale, estimated * scale, nominal * scale);
        prop_assert!((plain - scaled.unwrap()).abs() < 1e-9);
        let mirrored = parameter_improvement_percent(-actual, -estimated, -nominal).unwrap();
        prop_assert!((plain - mirrored).abs() < 1e-9);
    }

    #[test]
    fn rms_lies_between_mean_magnitude_and_largest(
        values in proptest::collection::vec(-1e3..1e3_f64, 1..40),
    ) {
        let value = rms(&values).unwrap();
        let mean = values.iter().map(|v| v.abs()).sum::<f64>() / values.len() as f64;
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        prop_assert!(value >= mean * (1.0 - 1e-12) && value <= largest * (1.0 + 1e-12));
    }

    #[test]
    fn gap_reduction_without_noise_is_eq_8_of_the_rms(
        before in 0.1..10.0_f64, after in 0.0..10.0_f64,
    ) {
        let gap = gap_reduction_percent(before, after, 0.0).unwrap();
        prop_assert!((gap - 100.0 * (1.0 - after / before)).abs() < 1e-9);
    }
}
