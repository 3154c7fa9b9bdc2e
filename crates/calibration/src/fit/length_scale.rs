//! What all lengths of a device are in proportion to, in their intervals: the scale of the instruments that measure them, or a
//! length that is held where touches alone were measured.

use haptical_identification::Matrix;
use haptical_model::{Device, LengthScale, ParameterId, Recording, SurroundingParameter};

use crate::error::wrap;
use crate::fit::considered::{Considered, Held, second_moment, sensitivity};
use crate::fit::size::{held_for_size, is_open};
use crate::problem::form::{Prepared, reduce};
use crate::{CalibrationError, Channel, DeviceProblem, ParameterFit, Weights};

/// Rows that stand for all of a longer recording: how a scale moves the parameters follows from the postures, and so many
/// show them all.
const MOST_ROWS: usize = 4096;

/// Makes the intervals of a fit contain the scale of the instruments by which it measured lengths: with readings
/// (1 + s) times too long, s of the stated deviation ([`haptical_model::Device::length_scales`]), the fitted parameters are off by
/// -(J^T J)^-1 J^T J_s s, J_s the derivatives by s. No residual shows it, since a device that is larger as a whole reads
/// the same. An instrument whose scale the fit itself has among its parameters adds nothing. Where touches alone were measured
/// ([`crate::held_for_scale`]) the length that is held stands in the place of a scale, with its plausible size: residuals say
/// nothing of it either, since those of touches shrink with the device.
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
    let (why, scales) = scales(&fit, channels);
    if scales.is_empty() || fit.fitted.is_empty() {
        return Ok(fit);
    }
    let own = fit.fitted.iter().map(|&index| fit.parameters[index]);
    let (parameters, sizes): (Vec<ParameterId>, Vec<f64>) = scales.into_iter().unzip();
    let all: Vec<ParameterId> = own.chain(parameters.iter().copied()).collect();
    let follows = |recording: &Recording| {
        let problem = DeviceProblem::new(&fit.device, recording, channels, &all, weights)?;
        let prepared = Prepared::new(&problem)?;
        let failed = |source| wrap("scale of an instrument", source);
        let reduction = reduce(prepared.searched(), &problem.start()).map_err(failed)?;
        let columns: Vec<usize> = (0..all.len()).collect();
        let (first, second) = columns.split_at(fit.fitted.len());
        let (sensitivity, rests) = sensitivity(&reduction, first, second).map_err(failed)?;
        if why == Held::Size {
            let square = |a: usize, b: usize| if a == b { sizes[a].powi(2) } else { 0.0 };
            let count = sizes.len();
            return Ok((sensitivity, Matrix::from_fn(count, count, square)));
        }
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
    fit.considered = fit.considered.with(&Considered {
        held: vec![why; parameters.len()],
        parameters,
        covariance,
        sensitivity,
        ..Considered::none(fit.fitted.len())
    });
    fit.considered
        .widen(&mut fit.estimates, &fit.fitted, &fit.uncertainty, fit.noise);
    Ok(fit)
}

/// What the lengths are in proportion to, with its standard deviations, and why it is held.
fn scales(fit: &ParameterFit, channels: &[Channel]) -> (Held, Vec<(ParameterId, f64)>) {
    if is_open(&fit.device, channels) {
        let held = held_for_size(fit, &fit.device).into_iter();
        let lengths = held.filter(|parameter| parameter.unit(&fit.device) == "m");
        let sized = lengths.map(|parameter| (parameter, parameter.plausible_size(&fit.device)));
        return (Held::Size, sized.collect());
    }
    let open = open_length_scales(&fit.device, channels, &fit.parameters);
    let open = open.into_iter();
    let named = open.map(|scale| (ParameterId::Surrounding(scale.parameter), scale.sd));
    (Held::Scale, named.collect())
}

/// The scales of the instruments behind `channels` that are not exact and not among `parameters`.
pub fn open_length_scales(
    device: &Device,
    channels: &[Channel],
    parameters: &[ParameterId],
) -> Vec<LengthScale> {
    let scales = device.length_scales().into_iter();
    let scales = scales.filter(|scale| scale.sd > 0.0 && measures(channels, scale.parameter));
    let is_open =
        |scale: &LengthScale| !parameters.contains(&ParameterId::Surrounding(scale.parameter));
    scales.filter(is_open).collect()
}

/// Whether a channel reads lengths on a scale.
fn measures(channels: &[Channel], scale: SurroundingParameter) -> bool {
    channels.iter().any(|channel| match (*channel, scale) {
        (Channel::Cable { index }, SurroundingParameter::CableScale { cable }) => index == cable,
        (Channel::Position, SurroundingParameter::TrackerScale) => true,
        _ => false,
    })
}
