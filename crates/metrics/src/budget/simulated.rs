//! Distributions propagated by draws (JCGM 101), and whether the law of uncertainties agrees with them.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

use super::combined::Combined;
use super::distribution::{Input, standard_normal, student_factor};
use crate::error::{
    MetricsError, check_all_finite, check_count, check_level, check_range, check_same_length,
};

/// Least trials: the ends of a 99 % interval are draws among the last few hundred of this many (JCGM 101, 7.2.2: ten thousand
/// times 1 / (1 - p)).
const LEAST_TRIALS: usize = 10_000;

/// A result by draws.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Simulated {
    /// Draws.
    pub trials: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_uncertainty: f64,
    /// Probability of the interval.
    pub level: f64,
    /// Interval with as much probability below as above.
    pub interval: [f64; 2],
    /// Shortest interval.
    pub shortest: [f64; 2],
}

/// Whether an expanded uncertainty agrees with draws (JCGM 101, clause 8).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Agreement {
    /// Numerical tolerance delta: half of the last digit of the standard uncertainty.
    pub tolerance: f64,
    /// Distances of the two low and of the two high ends.
    pub distances: [f64; 2],
    /// Standard deviation of an end by draws.
    pub scatter: f64,
    /// Whether neither distance is larger than the tolerance and twice the scatter.
    pub holds: bool,
}

/// Draws independent inputs and a correlated group, about 0, and collects what the model makes of them.
///
/// `covariance` (row by row, may be empty) and `degrees_of_freedom` are those of the group, whose draws are of the joint Student
/// distribution (JCGM 101, 6.4.8, 6.4.9). The model gets the draws of `inputs`, then those of the group.
///
/// # Errors
/// Fewer than ten thousand trials, a covariance that is none, a result that is not finite.
///
/// # Examples
/// ```
/// use haptical_metrics::budget::{Distribution, Input, simulated};
/// let own = Input::new(Distribution::Rectangular { half_width: 1.0 }, f64::INFINITY);
/// let found = simulated(&[own], (&[], f64::INFINITY), |x| 2.0 * x[0], 50_000, 0.95, 1)?;
/// assert!((found.interval[1] - 1.9).abs() < 0.02 && (found.standard_uncertainty - 2.0 / 3.0_f64.sqrt()).abs() < 0.02);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn simulated(
    inputs: &[Input],
    (covariance, degrees_of_freedom): (&[f64], f64),
    mut model: impl FnMut(&[f64]) -> f64,
    trials: usize,
    level: f64,
    seed: u64,
) -> Result<Simulated, MetricsError> {
    check_count("trials", trials, LEAST_TRIALS)?;
    check_level(level)?;
    check_range(
        "degrees of freedom",
        degrees_of_freedom,
        degrees_of_freedom > 0.0,
        "above 0",
    )?;
    let sizes: Vec<f64> = inputs.iter().map(Input::standard_uncertainty).collect();
    check_all_finite("standard uncertainties", &sizes)?;
    let root = root_of(covariance)?;
    let normal = Normal::standard();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let count = root.nrows();
    let mut draws = vec![0.0; inputs.len() + count];
    let mut own = vec![0.0; count];
    let mut results = Vec::with_capacity(trials);
    for _ in 0..trials {
        for (draw, input) in draws.iter_mut().zip(inputs) {
            *draw = input.draw(&mut rng, &normal);
        }
        if count > 0 {
            let factor = student_factor(degrees_of_freedom, &mut rng, &normal);
            for draw in &mut own {
                *draw = factor * standard_normal(&mut rng, &normal);
            }
            for row in 0..count {
                let parts = (0..count).map(|column| root[(row, column)] * own[column]);
                draws[inputs.len() + row] = parts.sum();
            }
        }
        results.push(model(&draws));
    }
    check_all_finite("a result", &results)?;
    results.sort_by(f64::total_cmp);
    Ok(summary(&results, level))
}

/// Mean, standard deviation and intervals of sorted results (JCGM 101, 7.6 and 7.7).
fn summary(results: &[f64], level: f64) -> Simulated {
    let count = results.len() as f64;
    let mean = results.iter().sum::<f64>() / count;
    let square: f64 = results.iter().map(|result| (result - mean).powi(2)).sum();
    let held = ((level * count).round() as usize).clamp(1, results.len() - 1);
    let low = (results.len() - held) / 2;
    let widths = (0..results.len() - held).map(|start| results[start + held] - results[start]);
    let shortest = widths.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    let start = shortest.map_or(low, |(start, _)| start);
    Simulated {
        trials: results.len(),
        mean,
        standard_uncertainty: (square / (count - 1.0)).sqrt(),
        level,
        interval: [results[low], results[low + held]],
        shortest: [results[start], results[start + held]],
    }
}

/// A matrix whose product with its own transpose is the covariance; of a singular one too.
fn root_of(covariance: &[f64]) -> Result<DMatrix<f64>, MetricsError> {
    let count = covariance.len().isqrt();
    check_same_length(
        ("the covariance", covariance.len()),
        ("a square of a whole number", count * count),
    )?;
    check_all_finite("the covariance", covariance)?;
    if count == 0 {
        return Ok(DMatrix::zeros(0, 0));
    }
    let matrix = DMatrix::from_row_slice(count, count, covariance);
    let parts = matrix.symmetric_eigen();
    let largest = parts.eigenvalues.iter().copied().fold(0.0, f64::max);
    if let Some(&got) = parts
        .eigenvalues
        .iter()
        .find(|value| **value < -1e-9 * largest)
    {
        let (what, allowed) = ("a variance of the covariance", "at least 0");
        return Err(MetricsError::OutOfRange { what, got, allowed });
    }
    let sizes = parts.eigenvalues.map(|value| value.max(0.0).sqrt());
    Ok(parts.eigenvectors * DMatrix::from_diagonal(&sizes))
}

/// Compares `estimate +- U` with an interval by draws: the standard uncertainty with so many significant digits is c 10^l, and the
/// tolerance is half of 10^l (JCGM 101, 7.9.2 and clause 8). An end of so many draws scatters by `u sqrt(q (1 - q) / trials) / phi(z_q)`
/// (the order statistic of a normal distribution), which is no disagreement: give draws enough that it is far below the tolerance.
///
/// # Errors
/// A standard uncertainty of 0, or no digit.
///
/// # Examples
/// ```
/// use haptical_metrics::budget::{Distribution, Group, Input, agreement, combined, simulated};
/// let own = Input::new(Distribution::Rectangular { half_width: 1.0 }, f64::INFINITY);
/// let by_law = combined(&[Group::single(1.0, &own)], 0.95)?;
/// let by_draws = simulated(&[own], (&[], f64::INFINITY), |x| x[0], 50_000, 0.95, 1)?;
/// // k = 1.96 is no factor of a single rectangular input: 1.13 for 0.95
/// assert!(!agreement(0.0, &by_law, &by_draws, 2)?.holds);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn agreement(
    estimate: f64,
    by_law: &Combined,
    by_draws: &Simulated,
    digits: u32,
) -> Result<Agreement, MetricsError> {
    let size = by_law.standard_uncertainty;
    let is_within = size > 0.0 && size.is_finite();
    check_range("the standard uncertainty", size, is_within, "above 0")?;
    check_range(
        "digits",
        f64::from(digits),
        (1..=4).contains(&digits),
        "1 to 4",
    )?;
    let shift = f64::from(digits) - 1.0;
    let power = |size: f64| size.log10().floor() - shift;
    // 0.0996 with two digits is 0.10
    let unit = 10.0_f64.powf(power(size));
    let rounded = (size / unit).round() * unit;
    let tolerance = 0.5 * 10.0_f64.powf(power(rounded * (1.0 + 1e-12)));
    let expanded = by_law.expanded_uncertainty;
    let [low, high] = by_draws.interval;
    let distances = [
        (estimate - expanded - low).abs(),
        (estimate + expanded - high).abs(),
    ];
    let share = 0.5 * (1.0 - by_draws.level);
    let density = Normal::standard().pdf(Normal::standard().inverse_cdf(share));
    let trials = by_draws.trials as f64;
    let scatter = by_draws.standard_uncertainty * (share * (1.0 - share) / trials).sqrt() / density;
    let most = tolerance + 2.0 * scatter;
    Ok(Agreement {
        tolerance,
        distances,
        scatter,
        holds: distances.iter().all(|distance| *distance <= most),
    })
}
