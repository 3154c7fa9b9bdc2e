//! Profile-likelihood intervals where the sum of squares is no parabola over a linearised one.

use crate::problem::sum_of_squares;
use crate::search::state::{SMALLEST_SCALE, UNSEEN_STEP};
use crate::{IdentificationError, Problem, Settings, Uncertainty, solve};

/// Ends of a parameter's interval by its profile likelihood.
///
/// The profile of parameter k is S_k(x), the least sum of squares where k is held at x. An interval ends where
/// S_k(x) - S = (h f)^2, with h the quantile that the linearised interval has in standard deviations and f the factor
/// on the stated noise: for a linear model that is the linearised interval itself (Bates & Watts, *Nonlinear
/// Regression Analysis*, 1988, section 6.1.2; Venzon & Moolgavkar 1988).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Index of the parameter.
    pub parameter: usize,
    /// Lower and upper end less the estimate; none where the profile stays below its limit up to
    /// [`FARTHEST`] times as far as the linearised end.
    pub ends: [Option<f64>; 2],
}

/// Half widths by which the linearised end may miss the profile's before the profile is searched.
pub const TOLERATED: f64 = 0.05;
/// Linearised half widths from the estimate at which a profile counts as open.
pub const FARTHEST: f64 = 30.0;
/// Half widths to which an end is searched.
const EXACT: f64 = 0.005;
/// Most fits for one end.
const MOST_FITS: usize = 25;
/// [`Settings::cost_tolerance`] of these fits: beside the rise that is sought, what they leave is below a millionth.
const FALL_LEFT: f64 = 1e-9;

/// Compares the linearised interval of each column of `spread` with the sum of squares at its two ends, the other
/// parameters moved along as the covariance says, and searches the profile of those where they differ by more
/// than [`TOLERATED`]. `half_width` is in standard deviations ([`Uncertainty::half_width_95`]), `cost` the sum of
/// squares at the minimum `values`.
///
/// Costs two evaluations of the residuals for each column, and some fits for each that is searched.
///
/// ```
/// # use haptical_identification::*;
/// /// exp(p) = 2 within 0.5: curved.
/// struct Exponential;
/// impl Problem for Exponential {
///     fn parameter_count(&self) -> usize { 1 }
///     fn residual_count(&self) -> usize { 1 }
///     fn evaluate(
///         &self,
///         p: &[f64],
///         residuals: &mut [f64],
///         jacobian: Option<(&[usize], &mut Matrix)>,
///     ) -> Result<(), IdentificationError> {
///         residuals[0] = (p[0].exp() - 2.0) / 0.5;
///         if let Some((free, matrix)) = jacobian {
///             for column in 0..free.len() {
///                 matrix[(0, column)] = p[0].exp() / 0.5;
///             }
///         }
///         Ok(())
///     }
/// }
/// let settings = Settings::default();
/// let fit = solve(&Exponential, &[0.0], &[0], &settings)?;
/// let spread = uncertainty(&fit.reduction, &[0], fit.cost, NoiseScale::Stated)?;
/// let h = spread.half_width_95(NoiseScale::Stated);
/// let found = profiles(&Exponential, &fit.parameters, fit.cost, &spread, h, &settings)?;
/// let upper = fit.parameters[0] + found[0].ends[1].unwrap();
/// assert!((upper - (2.0 + 0.5 * h).ln()).abs() < 1e-3);
/// # Ok::<(), IdentificationError>(())
/// ```
///
/// # Errors
/// Those of [`solve`] where the problem cannot be evaluated at the minimum.
pub fn profiles<P: Problem + ?Sized>(
    problem: &P,
    values: &[f64],
    cost: f64,
    spread: &Uncertainty,
    half_width: f64,
    settings: &Settings,
) -> Result<Vec<Profile>, IdentificationError> {
    let mut residuals = vec![0.0; problem.residual_count()];
    let search = Searched {
        problem,
        values,
        cost,
        limit: half_width * spread.noise_factor,
        spread,
        settings: Settings {
            cost_tolerance: settings.cost_tolerance.max(FALL_LEFT),
            ..settings.clone()
        },
    };
    let mut found = Vec::new();
    for position in 0..spread.columns.len() {
        let end = half_width * spread.standard_deviation(position);
        // where a fit is exact, the sum of squares over the interval is rounding
        let value = values[spread.columns[position]];
        if !(end > UNSEEN_STEP * (value.abs() + SMALLEST_SCALE) && search.limit > 0.0) {
            continue;
        }
        let is_straight = [-end, end].into_iter().all(|offset| {
            let trial = search.moved(position, offset);
            let size = match problem.evaluate(&trial, &mut residuals, None) {
                Ok(()) => search.size(sum_of_squares(&residuals)),
                Err(_) => f64::INFINITY,
            };
            (size - 1.0).abs() <= TOLERATED
        });
        if !is_straight {
            let ends = [-end, end].map(|offset| search.end(position, offset));
            let is_as_linear = ends.iter().all(|found| {
                found.is_some_and(|found| (found.abs() / end - 1.0).abs() <= TOLERATED)
            });
            // the others bend along: moving them straight made the sum of squares rise faster
            if !is_as_linear {
                found.push(Profile {
                    parameter: spread.columns[position],
                    ends,
                });
            }
        }
    }
    Ok(found)
}

struct Searched<'a, P: ?Sized> {
    problem: &'a P,
    values: &'a [f64],
    cost: f64,
    /// Square root of the limit on the rise of the sum of squares.
    limit: f64,
    spread: &'a Uncertainty,
    settings: Settings,
}

impl<P: Problem + ?Sized> Searched<'_, P> {
    /// The parameters with one moved by `offset` and the others as the covariance moves them with it.
    fn moved(&self, position: usize, offset: f64) -> Vec<f64> {
        let mut trial = self.values.to_vec();
        let covariance = &self.spread.covariance;
        let variance = covariance[(position, position)];
        for (other, &column) in self.spread.columns.iter().enumerate() {
            trial[column] += offset * covariance[(other, position)] / variance;
        }
        trial[self.spread.columns[position]] = self.values[self.spread.columns[position]] + offset;
        trial
    }

    /// How far a sum of squares is from the minimum: 1 at the end of an interval, in proportion to the offset for a
    /// linear model.
    fn size(&self, cost: f64) -> f64 {
        (cost - self.cost).max(0.0).sqrt() / self.limit
    }

    /// The offset at which the profile has risen to its limit, on the side of the linearised end `linear`.
    fn end(&self, position: usize, linear: f64) -> Option<f64> {
        let held = self.spread.columns[position];
        let others = self.spread.columns.iter().copied();
        let others: Vec<usize> = others.filter(|column| *column != held).collect();
        let (mut inside, mut outside) = ((0.0, 0.0), None::<(f64, f64)>);
        let mut share: f64 = 1.0;
        for _ in 0..MOST_FITS {
            let trial = self.moved(position, share * linear);
            let size = match self.profile(&trial, &others) {
                Some(cost) => self.size(cost),
                // there is no model out there
                None => f64::INFINITY,
            };
            if (size - 1.0).abs() <= EXACT {
                return Some(share * linear);
            }
            if size < 1.0 {
                inside = (share, size);
            } else {
                outside = Some((share, size));
            }
            if share >= FARTHEST && size < 1.0 {
                return None;
            }
            share = match outside {
                None => (share / size.max(0.1) * 1.02)
                    .min(3.0 * share)
                    .min(FARTHEST),
                Some(beyond) => between(inside, beyond),
            };
        }
        Some(share * linear)
    }

    /// The least sum of squares where the held parameter is as in `trial`.
    fn profile(&self, trial: &[f64], others: &[usize]) -> Option<f64> {
        if others.is_empty() {
            let mut residuals = vec![0.0; self.problem.residual_count()];
            self.problem.evaluate(trial, &mut residuals, None).ok()?;
            return Some(sum_of_squares(&residuals));
        }
        let fit = solve(self.problem, trial, others, &self.settings).ok()?;
        Some(fit.cost)
    }
}

/// Where the line through two sizes is 1, kept off the ends of the bracket.
fn between(inside: (f64, f64), outside: (f64, f64)) -> f64 {
    let (from, to) = (inside.0, outside.0);
    let slope = (outside.1 - inside.1) / (to - from);
    let crossing = from + (1.0 - inside.1) / slope;
    let margin = 0.1 * (to - from);
    if crossing.is_finite() {
        crossing.clamp(from + margin, to - margin)
    } else {
        0.5 * (from + to)
    }
}
