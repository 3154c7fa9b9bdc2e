//! Levels and spreads that a few odd episodes do not move.

/// What a median absolute deviation of a normal distribution is times to be its standard deviation.
pub(super) const NORMAL_MEDIAN: f64 = 1.4826;

/// Median; 0 of no values.
pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let (middle, length) = (values.len() / 2, values.len());
    let (below, upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let upper = *upper;
    if length % 2 == 1 {
        return upper;
    }
    0.5 * (upper + below.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

/// Scatter of a series about levels that may change: of differences of neighbours, which a change touches once.
pub(super) fn scatter(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    NORMAL_MEDIAN * median(&mut steps) / std::f64::consts::SQRT_2
}

/// Sum of absolute deviations from the median.
pub(super) fn deviation(values: &[f64]) -> f64 {
    let middle = median(&mut values.to_vec());
    values.iter().map(|value| (value - middle).abs()).sum()
}

/// Standard deviation.
pub(super) fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
