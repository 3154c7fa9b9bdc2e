//! Statistics of samples, and how far they may stray.

/// Standard errors that a mean or a standard deviation may be off: exceeded with probability 6e-7.
const STANDARD_ERRORS: f64 = 5.0;

/// Bins of the chi-square test, equally probable.
const BINS: usize = 20;

/// Limit of chi-square with 19 degrees of freedom: exceeded with probability 4e-6.
const CHI_SQUARE_LIMIT: f64 = 60.0;

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

pub(crate) fn sd(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}

/// Asserts mean 0 and the standard deviation `want`, for values whose tails are no longer than
/// normal ones (the standard error of their standard deviation is at most want / sqrt(2 n)).
#[track_caller]
pub(crate) fn assert_centred(values: &[f64], want: f64, what: &str) {
    let n = values.len() as f64;
    let (mean, sd) = (mean(values), sd(values));
    let limit = STANDARD_ERRORS * want / n.sqrt();
    assert!(mean.abs() < limit, "{what}: mean {mean:e}, limit {limit:e}");
    let limit = STANDARD_ERRORS * want / (2.0 * n).sqrt();
    let off = (sd - want).abs();
    assert!(
        off < limit,
        "{what}: sd {sd:e}, want {want:e} within {limit:e}"
    );
}

/// Asserts that values in [0, 1] are uniform.
#[track_caller]
pub(crate) fn assert_uniform(shares: &[f64], what: &str) {
    let mut bins = [0_usize; BINS];
    for share in shares {
        assert!((0.0..=1.0).contains(share), "{what}: {share}");
        bins[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let expected = shares.len() as f64 / BINS as f64;
    let chi_square: f64 = bins
        .iter()
        .map(|&count| (count as f64 - expected).powi(2) / expected)
        .sum();
    assert!(
        chi_square < CHI_SQUARE_LIMIT,
        "{what}: chi-square {chi_square}"
    );
}

/// Asserts that two samples of equal length are not correlated.
#[track_caller]
pub(crate) fn assert_uncorrelated(a: &[f64], b: &[f64], what: &str) {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let products = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b));
    let n = a.len() as f64;
    let correlation = products.sum::<f64>() / (n - 1.0) / sd(a) / sd(b);
    let limit = STANDARD_ERRORS / n.sqrt();
    assert!(
        correlation.abs() < limit,
        "{what}: correlation {correlation}"
    );
}

/// Share of the standard normal distribution below `z`.
pub(crate) fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

/// Differences of two columns.
pub(crate) fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
