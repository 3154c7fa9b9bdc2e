//! Quantiles against hand-computed values, correlations against closed forms.

use haptical_metrics::{
    Interval, MetricsError, correlation, median, percentile_interval, quantile, spearman,
};
use proptest::prelude::*;

/// Rounding of one interpolation between numbers near 10.
const ROUNDING: f64 = 1e-13;

#[test]
fn quantiles_are_of_type_7() {
    // R 4: quantile(c(7, 1, 9, 3, 4), c(0, .1, .3, .5, .95, 1)) = 1.0 1.8 3.2 4.0 8.6 9.0
    let values = [7.0, 1.0, 9.0, 3.0, 4.0];
    let expected = [
        (0.0, 1.0),
        (0.1, 1.8),
        (0.3, 3.2),
        (0.5, 4.0),
        (0.95, 8.6),
        (1.0, 9.0),
    ];
    for (p, expected) in expected {
        let found = quantile(&values, p).unwrap();
        assert!((found - expected).abs() < ROUNDING, "{p}: {found}");
    }
    assert_eq!(median(&[2.0, 8.0, 4.0, 6.0]).unwrap(), 5.0);
    assert_eq!(median(&[3.5]).unwrap(), 3.5);
}

#[test]
fn percentile_interval_is_central() {
    let values: Vec<f64> = (0..=100).rev().map(f64::from).collect();
    let interval = percentile_interval(&values, 0.9).unwrap();
    assert!((interval.low - 5.0).abs() < ROUNDING && (interval.high - 95.0).abs() < ROUNDING);
    assert!(interval.contains(5.5) && !interval.contains(4.5) && !interval.contains(95.5));
    assert!((interval.width() - 90.0).abs() < ROUNDING);
    let text = serde_json::to_string(&interval).unwrap();
    assert_eq!(serde_json::from_str::<Interval>(&text).unwrap(), interval);
}

#[test]
fn quantile_refuses_bad_arguments() {
    assert!(matches!(
        quantile(&[], 0.5),
        Err(MetricsError::TooFew { .. })
    ));
    assert!(matches!(
        quantile(&[1.0, f64::NAN], 0.5),
        Err(MetricsError::NonFinite { index: 1, .. })
    ));
    for p in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(
            quantile(&[1.0], p),
            Err(MetricsError::OutOfRange { .. })
        ));
    }
    for level in [0.0, 1.0, f64::NAN] {
        assert!(percentile_interval(&[1.0, 2.0], level).is_err());
    }
}

#[test]
fn correlation_matches_closed_forms() {
    // Deviations (-1.5, -0.5, 0.5, 1.5) and (-1, 1, -1, 1): r = 2 / sqrt(5 * 4).
    let r = correlation(&[1.0, 2.0, 3.0, 4.0], &[0.0, 2.0, 0.0, 2.0]).unwrap();
    assert!((r - 2.0 / 20.0_f64.sqrt()).abs() < ROUNDING, "{r}");
    let sine: Vec<f64> = (0..64)
        .map(|k| (f64::from(k) * 0.098_174_770_424_681_04).sin())
        .collect();
    let cosine: Vec<f64> = (0..64)
        .map(|k| (f64::from(k) * 0.098_174_770_424_681_04).cos())
        .collect();
    assert!(correlation(&sine, &cosine).unwrap().abs() < ROUNDING);
}

#[test]
fn spearman_shares_ranks_of_equal_values() {
    // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: r = 4.5 / sqrt(4.5 * 5).
    let r = spearman(&[1.0, 5.0, 5.0, 9.0], &[-3.0, -2.0, 0.0, 100.0]).unwrap();
    assert!((r - 4.5 / 22.5_f64.sqrt()).abs() < ROUNDING, "{r}");
    let falling = spearman(&[1.0, 2.0, 3.0], &[1.0, 0.1, 0.01]).unwrap();
    assert!((falling + 1.0).abs() < ROUNDING);
}

#[test]
fn correlation_refuses_constant_and_unequal_series() {
    // 0.1 is not a binary fraction: a mean with a rounding error must not pass for variation.
    for function in [correlation, spearman] {
        let constant = function(&[0.1, 0.1, 0.1], &[1.0, 2.0, 3.0]).unwrap_err();
        assert_eq!(
            constant,
            MetricsError::ConstantSeries {
                what: "x",
                value: 0.1
            }
        );
        assert!(function(&[1.0, 2.0], &[1.0]).is_err());
        assert!(function(&[1.0], &[1.0]).is_err());
        assert!(function(&[1.0, f64::INFINITY], &[1.0, 2.0]).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn quantile_is_monotone_and_inside_the_sample(
        values in prop::collection::vec(-1e6..1e6_f64, 1..50), p in 0.0..1.0_f64, q in 0.0..1.0_f64,
    ) {
        let (low, high) = (quantile(&values, p.min(q)).unwrap(), quantile(&values, p.max(q)).unwrap());
        prop_assert!(low <= high);
        let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        prop_assert!(smallest <= low && high <= largest);
    }

    #[test]
    fn correlation_is_bounded_symmetric_and_free_of_units(
        pairs in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64), 3..30), scale in 0.1..10.0_f64,
    ) {
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let r = correlation(&x, &y).unwrap();
        prop_assert!((-1.0..=1.0).contains(&r));
        prop_assert!((r - correlation(&y, &x).unwrap()).abs() < 1e-12);
        let moved: Vec<f64> = x.iter().map(|v| -scale * v + 3.0).collect();
        prop_assert!((r + correlation(&moved, &y).unwrap()).abs() < 1e-9);
    }
}

/// Ten times a tenth is not one: the mean of equal values is a rounding off, which is no variation.
#[test]
fn equal_values_have_no_correlation_whatever_their_mean_rounds_to() {
    let rising: Vec<f64> = (0..10).map(f64::from).collect();
    for value in [0.1, 3.0, -7.7e5] {
        let constant = [value; 10];
        for function in [correlation, spearman] {
            assert!(matches!(
                function(&constant, &rising),
                Err(MetricsError::ConstantSeries { .. })
            ));
        }
    }
}
