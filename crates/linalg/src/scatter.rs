//! Standard deviations by what parts of the rows differ by.

/// Standard deviation of a number by its values without each part: the jackknife (Efron and Tibshirani 1993, 11).
///
/// ```
/// // without each of 1, 2 and 6 their mean is 4, 3.5 and 1.5; it has the variance 7 / 3
/// let sd = haptical_linalg::jackknife_sd([4.0, 3.5, 1.5].into_iter());
/// assert!((sd * sd - 7.0 / 3.0).abs() < 1e-12);
/// ```
pub fn jackknife_sd(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(1) as f64;
    (squares_about_mean(&values) * (count - 1.0) / count).sqrt()
}

/// Standard deviation of a sum of independent parts.
///
/// ```
/// let sd = haptical_linalg::sum_sd(&[1.0, 2.0, 6.0]);
/// assert!((sd * sd - 3.0 * 7.0).abs() < 1e-12);
/// ```
pub fn sum_sd(parts: &[f64]) -> f64 {
    let count = parts.len() as f64;
    (squares_about_mean(parts) * count / (count - 1.0).max(1.0)).sqrt()
}

fn squares_about_mean(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum()
}
