//! The noise of step 1 in step 2: the transmissions' covariance carried through the distances.

use haptical_identification::{Component, Matrix};
use haptical_model::{ParameterId, Recording};

use crate::error::wrap;
use crate::fit::considered::{Considered, Held, sensitivity};
use crate::problem::form::{Prepared, reduce};
use crate::{CalibrationError, Channel, DeviceProblem, ParameterFit, TransmissionFit, Weights};

/// Least share of the residuals' variance that is left to the channel's own noise once the part that step 1 put
/// there is taken off: the difference of two estimates may come out at zero.
const LEAST_SHARE: f64 = 0.05;

/// Makes the intervals of a kinematic fit (step 2) contain the noise of the transmissions (step 1).
///
/// Step 2 works at joint angles that step 1 corrected, so an error d of step 1's parameters moves its own by
/// G d, G = -(J^T J)^-1 J^T J_1 with J_1 the distances' derivatives by step 1's parameters; with C_1 their
/// covariance the fit's becomes C + G C_1 G^T. Where the noise was estimated from the residuals, what step 1 adds to
/// their sum, trace((I - H) J_1 C_1 J_1^T) with H = J (J^T J)^-1 J^T, is taken off first, or it would count twice.
/// Source: docs/equations.md, Covariance and intervals.
///
/// `recording`, `channels` and `weights` are those of the fit. Joints that step 1 left without a fit add nothing.
///
/// # Errors
/// [`CalibrationError`] where the device has no value at a row.
pub fn with_step_one_noise(
    fit: ParameterFit,
    transmissions: &[TransmissionFit],
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
) -> Result<ParameterFit, CalibrationError> {
    let what = "noise of step 1";
    let steps: Vec<&ParameterFit> = transmissions
        .iter()
        .filter_map(|step| step.fit.as_ref())
        .collect();
    let (parameters, held, covariance) = together(&steps);
    if parameters.is_empty() || fit.fitted.is_empty() {
        return Ok(fit);
    }
    let own = fit.fitted.iter().map(|&index| fit.parameters[index]);
    let all: Vec<ParameterId> = own.chain(parameters.iter().copied()).collect();
    let problem = DeviceProblem::new(&fit.device, recording, channels, &all, weights)?;
    let prepared = Prepared::new(&problem)?;
    let searched = prepared.searched();
    let failed = |source| wrap(what, source);
    let reduction = reduce(searched, &problem.start()).map_err(failed)?;
    let columns: Vec<usize> = (0..all.len()).collect();
    let (first, second) = columns.split_at(fit.fitted.len());
    let (sensitivity, rests) = sensitivity(&reduction, first, second).map_err(failed)?;
    let mut fit = fit;
    if fit.noise == haptical_identification::NoiseScale::Estimated {
        let mut leaked = 0.0;
        for (a, left) in rests.iter().enumerate() {
            for (b, right) in rests.iter().enumerate() {
                let product: f64 = left.iter().zip(right).map(|(x, y)| x * y).sum();
                leaked += covariance[(a, b)] * product;
            }
        }
        take_off(&mut fit, leaked);
    }
    let step_one = Considered {
        parameters,
        held,
        covariance,
        sensitivity,
        beyond_first_order: Vec::new(),
        by_torque_scale: Vec::new(),
        known_parts: parts(&steps),
        promised_fall: 0.0,
    };
    fit.considered = fit.considered.with(&step_one);
    fit.considered
        .widen(&mut fit.estimates, &fit.fitted, &fit.uncertainty, fit.noise);
    Ok(fit)
}

/// The uncertain parameters of all transmissions and the covariance of their errors, block by block.
fn together(steps: &[&ParameterFit]) -> (Vec<ParameterId>, Vec<Held>, Matrix) {
    let mut parameters = Vec::new();
    let mut held = Vec::new();
    let mut places = Vec::new();
    let blocks: Vec<Matrix> = (steps.iter().enumerate())
        .map(|(step, fit)| {
            let (own, covariance) = fit.uncertain();
            places.extend((0..own.len()).map(|position| (step, position)));
            parameters.extend(own);
            held.extend(fit.fitted.iter().map(|_| Held::Fitted));
            let considered = fit.considered.held.iter();
            held.extend(considered.filter(|held| **held != Held::Dependent));
            covariance
        })
        .collect();
    let covariance = Matrix::from_fn(places.len(), places.len(), |a, b| {
        let ((step, row), (other, column)) = (places[a], places[b]);
        if step == other {
            blocks[step][(row, column)]
        } else {
            0.0
        }
    });
    (parameters, held, covariance)
}

/// The parts of that covariance, where the noise of a step has memory.
fn parts(steps: &[&ParameterFit]) -> Vec<Component> {
    let sizes: Vec<usize> = steps.iter().map(|fit| fit.uncertain().0.len()).collect();
    let all = sizes.iter().sum();
    let mut first = 0;
    let mut parts = Vec::new();
    for (fit, size) in steps.iter().zip(sizes) {
        let own = fit.uncertainty.components.iter();
        parts.extend(own.map(|part| part.placed(first, all)));
        first += size;
    }
    parts
}

/// Takes what step 1 added to the residuals' sum of squares out of the noise that was estimated from it.
fn take_off(fit: &mut ParameterFit, leaked: f64) {
    if !(fit.cost > 0.0 && leaked > 0.0) {
        return;
    }
    let share = (1.0 - leaked / fit.cost).max(LEAST_SHARE);
    let spread = &mut fit.uncertainty;
    spread.noise_factor *= share.sqrt();
    for column in 0..spread.columns.len() {
        let entries = spread.covariance.column_mut(column).iter_mut();
        entries.for_each(|entry| *entry *= share);
    }
}
