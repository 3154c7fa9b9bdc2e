//! Intervals of a calibration where the sum of squares is no parabola over them.

use haptical_identification::{profiles, solve};
use haptical_model::Recording;

use crate::problem::form::Prepared;
use crate::{Channel, DeviceProblem, Options, ParameterFit, Weights};

/// Most residuals times parameters that are evaluated twice ([`Profiled::is_checked`] says it too).
const MOST_ROWS: usize = 400_000;
/// Standard deviations by which the minimum may move where the problem is put up at the fitted device.
const SAME_PLACE: f64 = 0.1;

/// Replaces the intervals of a fit by those of the profile likelihood where they differ. What widens an interval
/// beyond the noise (parameters that were held, a torque's scale) stays, added as a root of squares.
///
/// `recording`, `channels` and `weights` are those of the fit. Where the device has no value at a place that the
/// check needs, the intervals stay unchecked.
pub(crate) fn profile(
    fit: &mut ParameterFit,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
) {
    // the sum of squares says nothing of noise with memory, or of sizes that differ
    let is_usual = fit.channel_noise.is_empty() && !fit.is_widened;
    if !is_usual || fit.residuals.len() * fit.fitted.len() > MOST_ROWS {
        return;
    }
    let (device, parameters) = (fit.device.clone(), fit.parameters.clone());
    let problem = DeviceProblem::new(&device, recording, channels, &parameters, weights);
    let Ok(problem) = problem else {
        return;
    };
    let Ok(prepared) = Prepared::new(&problem) else {
        return;
    };
    let searched = prepared.searched();
    // at the fitted device torques and the weights of readings are a little different from those of the fit
    let Ok(again) = solve(searched, &problem.start(), &fit.fitted, &options.search) else {
        return;
    };
    let spread = &fit.uncertainty;
    let mut places = spread.columns.iter().enumerate();
    let is_there = places.all(|(position, &column)| {
        let moved = again.parameters[column] - fit.parameters[column].value(&fit.device);
        moved.abs() <= SAME_PLACE * spread.standard_deviation(position)
    });
    if !is_there {
        return;
    }
    let half_width = spread.half_width_95(fit.noise);
    let found = profiles(
        searched,
        &again.parameters,
        again.cost,
        spread,
        half_width,
        &options.search,
    );
    let Ok(found) = found else {
        return;
    };
    fit.profiled.is_checked = true;
    for profile in found {
        let index = profile.parameter;
        let Some(position) = fit.fitted.iter().position(|&fitted| fitted == index) else {
            continue;
        };
        let estimate = &mut fit.estimates[index];
        let (Some(value), Some(sd)) = (estimate.value, estimate.standard_deviation) else {
            continue;
        };
        let beyond_noise = sd.powi(2) - fit.uncertainty.covariance[(position, position)];
        let beyond_noise = half_width * beyond_noise.max(0.0).sqrt();
        let [lower, upper] = profile
            .ends
            .map(|end| end.map(|end| value + end.signum() * end.hypot(beyond_noise)));
        estimate.ci95 = lower.zip(upper).map(|(lower, upper)| [lower, upper]);
        fit.profiled.parameters.push(index);
        if estimate.ci95.is_none() {
            fit.profiled.open.push(index);
        }
    }
}
