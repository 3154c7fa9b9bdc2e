//! Standard uncertainties combined, their degrees of freedom, coverage factor and expanded uncertainty (JCGM 100).

use super::distribution::Input;
use crate::error::{
    MetricsError, check_all_finite, check_count, check_level, check_range, check_same_length,
    finite_result,
};
use crate::student_t_quantile;

/// Degrees of freedom that are as good as infinitely many.
const MANY: f64 = 1e9;

/// Input quantities that are known together: a single one, or several with their covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Sensitivity c_i of the result to each quantity.
    pub sensitivities: Vec<f64>,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Degrees of freedom of the covariance; infinite where it is known.
    pub degrees_of_freedom: f64,
}

/// A combined standard uncertainty and what is covered with it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Combined {
    /// Combined standard uncertainty u_c.
    pub standard_uncertainty: f64,
    /// Effective degrees of freedom; none where they are infinitely many.
    pub degrees_of_freedom: Option<f64>,
    /// Level of confidence.
    pub level: f64,
    /// Coverage factor k.
    pub coverage_factor: f64,
    /// Expanded uncertainty U = k u_c.
    pub expanded_uncertainty: f64,
}

impl Group {
    /// One quantity that is independent of the others.
    pub fn single(sensitivity: f64, input: &Input) -> Self {
        Self {
            sensitivities: vec![sensitivity],
            covariance: vec![input.standard_uncertainty().powi(2)],
            degrees_of_freedom: input.degrees_of_freedom,
        }
    }

    /// Its part of the variance, c^T V c.
    ///
    /// # Errors
    /// Another number of covariances than the square of that of sensitivities, a number that is not finite, or a variance
    /// below 0 by more than rounding.
    pub fn variance(&self) -> Result<f64, MetricsError> {
        let c = &self.sensitivities;
        let variance = covariance_of(c, c, &self.covariance)?;
        let size: f64 = (0..c.len())
            .map(|index| c[index].powi(2) * self.covariance[index * (c.len() + 1)])
            .sum();
        let is_within = variance >= -1e-9 * size.abs();
        check_range("a variance", variance, is_within, "at least 0")?;
        Ok(variance.max(0.0))
    }
}

/// Covariance of two results that depend on the same quantities: a^T V b (JCGM 100, H.2.3).
///
/// # Errors
/// Lengths that do not go together, and numbers that are not finite.
///
/// # Examples
/// ```
/// let covariance = haptical_metrics::budget::covariance_of(&[1.0, 1.0], &[1.0, -1.0], &[4.0, 0.5, 0.5, 1.0])?;
/// assert_eq!(covariance, 3.0);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn covariance_of(a: &[f64], b: &[f64], covariance: &[f64]) -> Result<f64, MetricsError> {
    check_same_length(
        ("the first sensitivities", a.len()),
        ("the second", b.len()),
    )?;
    check_same_length(
        ("the covariance", covariance.len()),
        ("the square of the sensitivities", a.len() * b.len()),
    )?;
    check_all_finite("the first sensitivities", a)?;
    check_all_finite("the second sensitivities", b)?;
    check_all_finite("the covariance", covariance)?;
    let rows = a.iter().zip(covariance.chunks_exact(b.len().max(1)));
    let products = rows.map(|(own, row)| {
        let along: f64 = row.iter().zip(b).map(|(entry, other)| entry * other).sum();
        own * along
    });
    finite_result("the covariance", products.sum())
}

/// Combines groups that are independent of each other.
///
/// u_c^2 is the sum of the groups' c^T V c (JCGM 100, eq. (10) and (16)); the effective degrees of freedom are
/// `u_c^4 / sum u_g^4 / nu_g` (Welch-Satterthwaite, eq. (G.2b)), a group of correlated quantities counting as one
/// quantity, as its variance is one estimate; k is Student's at that number, cut to a whole one (G.4.1).
///
/// # Errors
/// No group, a level outside 0 to 1, degrees of freedom that are not above 0, and the errors of [`Group::variance`].
///
/// # Examples
/// ```
/// use haptical_metrics::budget::{Distribution, Group, Input, combined};
/// // JCGM 100, G.4.1: equal parts of 10 and 5 degrees of freedom
/// let own = |degrees| Group::single(1.0, &Input::new(Distribution::Normal { standard_uncertainty: 1.0 }, degrees));
/// let both = combined(&[own(10.0), own(5.0)], 0.95)?;
/// assert!((both.degrees_of_freedom.unwrap() - 4.0 / (0.1 + 0.2)).abs() < 1e-12);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn combined(groups: &[Group], level: f64) -> Result<Combined, MetricsError> {
    check_count("a budget", groups.len(), 1)?;
    check_level(level)?;
    let (mut variance, mut spread) = (0.0, 0.0);
    for group in groups {
        let degrees = group.degrees_of_freedom;
        check_range("degrees of freedom", degrees, degrees > 0.0, "above 0")?;
        let own = group.variance()?;
        variance += own;
        spread += own * own / degrees;
    }
    finite_result("the combined variance", variance)?;
    let effective = variance * variance / spread;
    let is_finite = spread > 0.0 && effective < MANY;
    let counted = match is_finite {
        true => effective.floor().max(1.0),
        false => MANY,
    };
    let coverage_factor = student_t_quantile(level, counted)?;
    let standard_uncertainty = variance.sqrt();
    Ok(Combined {
        standard_uncertainty,
        degrees_of_freedom: is_finite.then_some(effective),
        level,
        coverage_factor,
        expanded_uncertainty: coverage_factor * standard_uncertainty,
    })
}
