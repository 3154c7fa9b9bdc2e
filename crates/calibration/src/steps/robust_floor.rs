//! Intervals of a robust fit whose noise is larger for a part of the readings.

use haptical_identification::{Component, Matrix, robust_covariance};
use haptical_model::Recording;

use crate::{DeviceProblem, ParameterFit, Robustness, Weights};

/// Factor on a standard deviation that two estimates of it differ by without a reason.
const SCATTER: f64 = 1.1;

/// Widens the intervals of a robust fit to those of readings that have noise of a size of their own: the factor that the loss
/// puts on the covariance is right for noise of one size (docs/equations.md, Robust losses).
///
/// `derivatives` and `residuals` are those of the weighted rows of `problem`.
pub(super) fn widen(
    fit: &mut ParameterFit,
    (problem, recording): (&DeviceProblem<'_>, &Recording),
    (derivatives, residuals): (&Matrix, &[f64]),
    (robust, weights): (&Robustness, &Weights),
) {
    let mut slopes = vec![1.0; residuals.len()];
    let mut mean_slopes = slopes.clone();
    let mut pulls: Vec<f64> = residuals
        .iter()
        .map(|residual| residual * residual)
        .collect();
    for block in &problem.blocks {
        let mut channels = robust.channels.iter();
        let Some(channel) = channels.find(|own| own.channel == block.channel) else {
            continue;
        };
        let (factor, width) = (channel.variance_factor, block.channel.width());
        let (mut bent, mut trusted) = (0.0, 0.0);
        for (reading, &row) in block.rows.iter().enumerate() {
            let line = recording.line.get(row).copied().unwrap_or(0);
            let trust = weights.trust(block.channel, line);
            let first = block.first + reading * width;
            let square: f64 = residuals[first..first + width].iter().map(|r| r * r).sum();
            // of one axis, in standard deviations of the good readings and not weighted
            let size = (square / width as f64 * factor / trust.max(f64::MIN_POSITIVE)).sqrt();
            let bend = robust.loss.influence_slope(size) - robust.loss.weight(size);
            bent += bend;
            trusted += robust.loss.weight(size);
            for row in first..first + width {
                let along = if square > 0.0 {
                    pulls[row] / square
                } else {
                    0.0
                };
                let slope = robust.loss.weight(size) + bend * along;
                slopes[row] = if trust > 0.0 {
                    factor * slope / trust
                } else {
                    0.0
                };
                pulls[row] *= factor * factor;
            }
        }
        let mean = factor * (1.0 + bent / width as f64 / f64::max(trusted, f64::MIN_POSITIVE));
        mean_slopes[block.first..block.first + width * block.rows.len()].fill(mean);
    }
    // where readings at the bend of psi decide, its mean slope
    let floor = robust_covariance(derivatives, &slopes, &pulls)
        .or_else(|| robust_covariance(derivatives, &mean_slopes, &pulls));
    let Some(floor) = floor else {
        return;
    };
    let usual = &fit.uncertainty.covariance;
    let factors: Vec<f64> = (0..usual.columns())
        .map(|k| (floor[(k, k)] / usual[(k, k)]).max(1.0).sqrt())
        .collect();
    if factors.iter().all(|factor| *factor < SCATTER) {
        return;
    }
    fit.is_widened = true;
    let mut components = fit.uncertainty.components.clone();
    if components.is_empty() {
        components.push(Component {
            covariance: usual.clone(),
            degrees_of_freedom: fit.uncertainty.degrees_of_freedom as f64,
        });
    }
    for part in &mut components {
        let own = &part.covariance;
        let wider = |a: usize, b: usize| factors[a] * own[(a, b)] * factors[b];
        part.covariance = Matrix::from_fn(factors.len(), factors.len(), wider);
    }
    fit.uncertainty = fit.uncertainty.clone().with_components(components);
}
