//! Tail probabilities, quantiles and intervals of the standard distributions.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};
use statrs::function::erf::erfc;

use crate::coverage::check_trials;
use crate::error::{MetricsError, check_finite, check_level, check_range, finite_result};
use crate::quantile::Interval;

/// Degrees of freedom from which the expansion of the Student quantile is exact to rounding.
const EXPANSION_DOF: f64 = 1000.0;

/// Probability that a chi-square variable exceeds the statistic: `P(X >= statistic)`.
///
/// `statistic` is a weighted sum of squared residuals (no unit); `degrees_of_freedom` is the number
/// of residuals less the number of fitted parameters. A small result says that the residuals are
/// larger than the stated noise explains. Source: Abramowitz & Stegun 26.4.
///
/// # Errors
/// [`MetricsError::OutOfRange`] for a negative statistic or degrees of freedom that are not
/// positive, [`MetricsError::NonFinite`] for a NaN or infinity.
///
/// # Examples
/// With two degrees of freedom the probability is `exp(-statistic / 2)`:
/// ```
/// let p = haptical_metrics::chi_square_p_value(3.0, 2.0)?;
/// assert!((p - (-1.5_f64).exp()).abs() < 1e-12);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn chi_square_p_value(statistic: f64, degrees_of_freedom: f64) -> Result<f64, MetricsError> {
    check_finite("statistic", statistic)?;
    check_range("statistic", statistic, statistic >= 0.0, "at least 0")?;
    check_degrees_of_freedom(degrees_of_freedom)?;
    let distribution = ChiSquared::new(degrees_of_freedom)
        .map_err(|_| degrees_out_of_range(degrees_of_freedom))?;
    Ok(finite_result("the chi-square probability", distribution.sf(statistic))?.clamp(0.0, 1.0))
}

/// The number below which a chi-square variable lies with probability `p`.
///
/// `degrees_of_freedom` need not be whole. Source: Abramowitz & Stegun 26.4.
///
/// # Errors
/// [`MetricsError::OutOfRange`] for `p` outside 0 to 1 (both excluded) or degrees of freedom that are not positive.
///
/// # Examples
/// With two degrees of freedom it is `-2 ln(1 - p)`:
/// ```
/// let q = haptical_metrics::chi_square_quantile(0.025, 2.0)?;
/// assert!((q + 2.0 * 0.975_f64.ln()).abs() < 1e-9);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn chi_square_quantile(p: f64, degrees_of_freedom: f64) -> Result<f64, MetricsError> {
    check_level(p)?;
    check_degrees_of_freedom(degrees_of_freedom)?;
    let distribution = ChiSquared::new(degrees_of_freedom)
        .map_err(|_| degrees_out_of_range(degrees_of_freedom))?;
    finite_result("the chi-square quantile", distribution.inverse_cdf(p))
}

/// Probability that a standard normal variable is at least as far from 0 as `z`:
/// `erfc(|z| / sqrt(2))`.
///
/// # Errors
/// [`MetricsError::NonFinite`] for a NaN or infinite `z`.
///
/// # Examples
/// ```
/// let p = haptical_metrics::normal_two_sided_p(-1.959963984540054)?;
/// assert!((p - 0.05).abs() < 1e-10);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn normal_two_sided_p(z: f64) -> Result<f64, MetricsError> {
    check_finite("z", z)?;
    Ok(erfc(z.abs() / std::f64::consts::SQRT_2).clamp(0.0, 1.0))
}

/// The `t` with `P(|T| <= t) = level` for Student's T: the factor of a two-sided interval.
///
/// `level` is the confidence level of the two-sided interval, not a one-sided probability: at
/// `level` 0.95 the result is the 0.975 quantile. `dof` is the number of degrees of freedom and
/// need not be whole. Source: Abramowitz & Stegun 26.7.
///
/// # Errors
/// [`MetricsError::OutOfRange`] for `level` outside 0 to 1 (both excluded) or `dof` not positive,
/// [`MetricsError::Overflow`] when the quantile is not representable.
///
/// # Examples
/// ```
/// let factor = haptical_metrics::student_t_quantile(0.95, 10.0)?;
/// assert!((factor - 2.228138852).abs() < 1e-8);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn student_t_quantile(level: f64, dof: f64) -> Result<f64, MetricsError> {
    check_level(level)?;
    check_degrees_of_freedom(dof)?;
    if dof >= EXPANSION_DOF {
        return Ok(student_t_expansion(0.5 * (1.0 + level), dof));
    }
    let distribution = StudentsT::new(0.0, 1.0, dof).map_err(|_| degrees_out_of_range(dof))?;
    finite_result(
        "the Student quantile",
        distribution.inverse_cdf(0.5 * (1.0 + level)),
    )
}

/// Student quantile as the normal quantile and four corrections in powers of 1 / dof.
///
/// Abramowitz & Stegun 26.7.5. The inverse of the incomplete beta function, used below
/// [`EXPANSION_DOF`], loses all digits for many degrees of freedom (a recording has 100 000).
fn student_t_expansion(p: f64, dof: f64) -> f64 {
    let z = Normal::standard().inverse_cdf(p);
    let z2 = z * z;
    let corrections = [
        (z2 + 1.0) / 4.0,
        ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
        ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92_160.0,
    ];
    z * (1.0
        + corrections
            .iter()
            .rev()
            .fold(0.0, |sum, term| (sum + term) / dof))
}

/// Wilson interval of a probability from counted successes.
///
/// With `p = successes / n` and `z` the normal quantile of `(1 + level) / 2`, the ends are
/// `(p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2)) / (1 + z^2/n)`. Source: Wilson, Probable inference,
/// the law of succession, and statistical inference, 1927.
///
/// # Errors
/// [`MetricsError::TooFew`] for `n` 0, [`MetricsError::OutOfRange`] for more successes than trials
/// or `level` outside 0 to 1 (both excluded).
///
/// # Examples
/// ```
/// let interval = haptical_metrics::wilson_interval(8, 10, 0.95)?;
/// assert!((interval.low - 0.4901625).abs() < 1e-6 && (interval.high - 0.9433178).abs() < 1e-6);
/// # Ok::<(), haptical_metrics::MetricsError>(())
/// ```
pub fn wilson_interval(successes: usize, n: usize, level: f64) -> Result<Interval, MetricsError> {
    check_level(level)?;
    check_trials(successes, n)?;
    let trials = n as f64;
    let share = successes as f64 / trials;
    let z = Normal::standard().inverse_cdf(0.5 * (1.0 + level));
    let per_trial = z * z / trials;
    let centre = share + 0.5 * per_trial;
    let half = (per_trial * (share * (1.0 - share) + 0.25 * per_trial)).sqrt();
    // The ends are exact where no or all trials succeed; rounding must not move them.
    let low = if successes == 0 {
        0.0
    } else {
        (centre - half) / (1.0 + per_trial)
    };
    let high = if successes == n {
        1.0
    } else {
        (centre + half) / (1.0 + per_trial)
    };
    Ok(Interval {
        low: low.clamp(0.0, 1.0),
        high: high.clamp(0.0, 1.0),
    })
}

fn check_degrees_of_freedom(degrees: f64) -> Result<(), MetricsError> {
    check_finite("degrees of freedom", degrees)?;
    if degrees > 0.0 {
        Ok(())
    } else {
        Err(degrees_out_of_range(degrees))
    }
}

fn degrees_out_of_range(got: f64) -> MetricsError {
    MetricsError::OutOfRange {
        what: "degrees of freedom",
        got,
        allowed: "greater than 0",
    }
}
