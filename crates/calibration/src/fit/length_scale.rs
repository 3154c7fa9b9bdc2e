//! The scale of the instruments that measure lengths, in the intervals of what was fitted to them.

use haptical_identification::Matrix;
use haptical_model::{LengthScale, ParameterId, Recording, SurroundingParameter};

use crate::error::wrap;
use crate::fit::considered::{Considered, Held, second_moment, sensitivity};
use crate::problem::form::{Prepared, reduce};
use crate::{CalibrationError, Channel, DeviceProblem, ParameterFit, Weights};

/// Rows that stand for all of a longer recording: how a scale moves the parameters follows from the postures, and so many
/// show them all.
const MOST_ROWS: usize = 4096;

/// Makes the intervals of a fit contain the scale of the instruments by which it measured lengths: with readings
/// (1 + s) times too long, s of the stated deviation ([`haptical_model::Device::length_scales`]), the fitted parameters are off by
/// -(J^T J)^-1 J^T J_s s, J_s the derivatives by s. No residual shows it, since a device that is larger as a whole reads
/// the same. An instrument whose scale the fit itself has among its parameters adds nothing.
/// Source: docs/equations.md, "Scale of an instrument".
///
/// `recording`, `channels` and `weights` are those of the fit.
///
/// # Errors
/// [`CalibrationError`] where the device has no value at a row.
pub(crate) fn with_length_scales(
    mut fit: ParameterFit,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
) -> Result<ParameterFit, CalibrationError> {
    let scales: Vec<LengthScale> = (fit.device.length_scales().into_iter())
        .filter(|scale| scale.sd > 0.0 && measures(channels, scale.parameter))
        .filter(|scale| !fit.parameters.contains(&parameter(scale)))
        .collect();
    if scales.is_empty() || fit.fitted.is_empty() {
        return Ok(fit);
    }
    let own = fit.fitted.iter().map(|&index| fit.parameters[index]);
    let all: Vec<ParameterId> = own.chain(scales.iter().map(parameter)).collect();
    let sizes: Vec<f64> = scales.iter().map(|scale| scale.sd).collect();
    let follows = |recording: &Recording| {
        let problem = DeviceProblem::new(&fit.device, recording, channels, &all, weights)?;
        let prepared = Prepared::new(&problem)?;
        let failed = |source| wrap("scale of an instrument", source);
        let reduction = reduce(prepared.searched(), &problem.start()).map_err(failed)?;
        let columns: Vec<usize> = (0..all.len()).collect();
        let (first, second) = columns.split_at(fit.fitted.len());
        let (sensitivity, rests) = sensitivity(&reduction, first, second).map_err(failed)?;
        // two instruments tell how their scales differ
        let factor = fit.uncertainty.noise_factor;
        let moment = second_moment(&rests, reduction.projected(), &sizes, factor);
        Ok::<(Matrix, Matrix), CalibrationError>((sensitivity, moment.map_err(failed)?))
    };
    let step = recording.len().div_ceil(MOST_ROWS);
    let some: Vec<usize> = (0..recording.len()).step_by(step.max(1)).collect();
    // a few rows may be all that fixes a parameter, and be left out
    let (sensitivity, covariance) = match step {
        0 | 1 => follows(recording)?,
        _ => match follows(&recording.select(&some)) {
            Ok(found) => found,
            Err(_) => follows(recording)?,
        },
    };
    let count = scales.len();
    fit.considered = fit.considered.with(&Considered {
        parameters: scales.iter().map(parameter).collect(),
        held: vec![Held::Scale; count],
        covariance,
        sensitivity,
        ..Considered::none(fit.fitted.len())
    });
    fit.considered
        .widen(&mut fit.estimates, &fit.fitted, &fit.uncertainty, fit.noise);
    Ok(fit)
}

fn parameter(scale: &LengthScale) -> ParameterId {
    ParameterId::Surrounding(scale.parameter)
}

/// Whether a channel reads lengths on a scale.
fn measures(channels: &[Channel], scale: SurroundingParameter) -> bool {
    channels.iter().any(|channel| match (*channel, scale) {
        (Channel::Cable { index }, SurroundingParameter::CableScale { cable }) => index == cable,
        (Channel::Position, SurroundingParameter::TrackerScale) => true,
        _ => false,
    })
}
