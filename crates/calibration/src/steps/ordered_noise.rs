//! Memory, drift and uneven size of the noise in the fits of a device.

use std::borrow::Cow;
use std::collections::BTreeMap;

use haptical_identification::{
    Component, CorrelatedNoise, FEWEST_ROWS, Matrix, OrderedProblem, Signal, Uncertainty,
    correlated_noise, evaluate_jacobian,
};
use haptical_model::{Device, ParameterId, Recording};

use crate::error::wrap;
use crate::fit::considered::sensitivity;
use crate::fit::length_scale::with_length_scales;
use crate::problem::device_problem::Block;
use crate::problem::form::{Prepared, reduce};
use crate::report::channel_noise::ChannelNoise;
use crate::steps::device::step_two;
use crate::steps::robust_floor;
use crate::{
    CalibrationError, CalibrationMethod, Channel, DeviceProblem, FittedDevice, ParameterFit,
    Robustness, Weights, channels, with_step_one_noise,
};

/// Local sizes of the noise by channel and line of the log.
type Sizes = BTreeMap<Channel, BTreeMap<u64, f64>>;

/// Most residuals times parameters of a fit whose noise is looked at row by row.
const MOST_ROWS: usize = 6_000_000;

/// Share of a fit's sum of squares that may bend along the step of its noise: a tenth of the noise.
const MOST_BENT: f64 = 0.01;

/// Factor by which lines in time may raise a fit's sum of squares, and the chance of such lines without a drift below which they may
/// raise it further.
const MOST_RAISED: f64 = 2.0;
const SURE_DRIFT: f64 = 1e-3;

/// Gives every fit of a device the covariance that its noise calls for: that of step 2 counts the noise of step 1
/// ([`with_step_one_noise`]), lengths count the scale of the instruments that they rest on, and noise that is not independent and of one size has its own ([`correlated_noise`]). Values move by a part of their uncertainty where rows are weighted by a local size of the
/// noise, or where a drift is fitted besides.
///
/// `recording` is that of the fits.
///
/// # Errors
/// [`CalibrationError`] where the device has no value at a row.
pub fn with_ordered_noise(
    mut fitted: FittedDevice,
    recording: &Recording,
    method: CalibrationMethod,
) -> Result<FittedDevice, CalibrationError> {
    let all = channels(&fitted.device, recording)?;
    let weights = fitted.weights.clone();
    let robust = fitted.robust.clone();
    let robust = robust.as_ref();
    let mut sizes = Sizes::new();
    if method == CalibrationMethod::Joint {
        if let Some(whole) = fitted.whole.take() {
            let whole = with_length_scales(whole, recording, &all, &weights)?;
            let whole = look(whole, recording, &all, (&weights, robust), &mut sizes)?;
            fitted.device.clone_from(&whole.device);
            fitted.whole = Some(whole);
        }
        fitted.weights.local_size = sizes;
        return Ok(fitted);
    }
    let mut moved = Vec::new();
    for step in &mut fitted.transmissions {
        let Some(before) = step.fit.take() else {
            continue;
        };
        let old = values(&before);
        let own = [Channel::Output { joint: step.joint }];
        let after = look(before, recording, &own, (&weights, robust), &mut sizes)?;
        let changes = values(&after).into_iter().zip(old);
        moved.extend(changes.filter_map(|((parameter, now), (_, was))| {
            (now != was).then_some((parameter, now - was))
        }));
        step.fit = Some(after);
    }
    let rows = step_two(&fitted.device, recording, &all);
    let whole = match (fitted.whole.take(), rows) {
        (Some(whole), Some((distant, rows))) => {
            let whole = follow(whole, &moved, (&rows, &distant), &weights)?;
            let steps = &fitted.transmissions;
            let whole = with_step_one_noise(whole, steps, &rows, &distant, &weights)?;
            let whole = with_length_scales(whole, &rows, &distant, &weights)?;
            Some(look(
                whole,
                &rows,
                &distant,
                (&weights, robust),
                &mut sizes,
            )?)
        }
        (whole, _) => whole,
    };
    move_device(&mut fitted.device, &moved);
    if let Some(whole) = &whole {
        fitted.device.clone_from(&whole.device);
    }
    fitted.whole = whole;
    fitted.weights.local_size = sizes;
    Ok(fitted)
}

/// Fitted parameters and their values.
fn values(fit: &ParameterFit) -> Vec<(ParameterId, f64)> {
    let own = fit.fitted.iter().map(|&index| fit.parameters[index]);
    own.map(|parameter| (parameter, parameter.value(&fit.device)))
        .collect()
}

fn move_device(device: &mut Device, moved: &[(ParameterId, f64)]) {
    for (parameter, change) in moved {
        let value = parameter.value(device) + change;
        parameter.set(device, value);
    }
}

/// A fit whose noise has been looked at.
fn look(
    mut fit: ParameterFit,
    recording: &Recording,
    channels: &[Channel],
    (weights, robust): (&Weights, Option<&Robustness>),
    sizes: &mut Sizes,
) -> Result<ParameterFit, CalibrationError> {
    let failed = |source| wrap("noise of a fit", source);
    if fit.fitted.is_empty() || fit.residuals.len() * fit.fitted.len() > MOST_ROWS {
        return Ok(fit);
    }
    let own: Vec<ParameterId> = fit
        .fitted
        .iter()
        .map(|&index| fit.parameters[index])
        .collect();
    let device = fit.device.clone();
    let held = &fit.considered.parameters;
    let all: Vec<ParameterId> = own.iter().chain(held).copied().collect();
    let problem = DeviceProblem::new(&device, recording, channels, &all, weights)?;
    let prepared = Prepared::new(&problem)?;
    let free: Vec<usize> = (0..all.len()).collect();
    let (derivatives, residuals) =
        evaluate_jacobian(prepared.row_by_row(), &problem.start(), &free).map_err(failed)?;
    // of the fit alone
    let of_fit = || {
        let entry = |row: usize, column: usize| derivatives[(row, column)];
        Matrix::from_fn(residuals.len(), own.len(), entry)
    };
    let known = fit.considered.known();
    let signals = signals(&problem, &own);
    fit.noise_is_checked = signals
        .iter()
        .any(|signal| signal.rows.len() >= FEWEST_ROWS);
    let found = correlated_noise(&OrderedProblem {
        derivatives: &derivatives,
        fitted: own.len(),
        residuals: &residuals,
        signals: &signals,
        covariates: &recording.joint,
        noise: fit.noise,
        known: Some(&known),
    });
    let Some(found) = found else {
        if let Some(robust) = robust {
            let rows = (&of_fit(), &residuals[..]);
            robust_floor::widen(&mut fit, (&problem, recording), rows, (robust, weights));
            take_step(&mut fit, &[], &[]);
        }
        return Ok(fit);
    };
    let changes: Vec<(ParameterId, f64)> = (own.iter().copied())
        .zip(found.step.iter().copied())
        .collect();
    let moved = residuals_after(&device, &changes, (recording, channels), weights);
    let moved = moved.filter(|after| {
        let both = (&residuals[..], &after[..]);
        is_linear(&derivatives, both, &found.step) && is_credible(both, found.drift_p_value)
    });
    fit.channel_noise = ChannelNoise::list(&found, &signals, channels, moved.is_some());
    if moved.is_some() {
        take_sizes(&problem, recording, &found, sizes);
    }
    let CorrelatedNoise {
        components, held, ..
    } = found;
    if let Some(effect) = held {
        fit.considered = fit.considered.reweighed(&device, &effect);
    }
    let components = match moved.is_some() {
        true => components,
        false => no_narrower(components, &fit.uncertainty),
    };
    fit.uncertainty = fit.uncertainty.with_components(components);
    if let Some(robust) = robust {
        let rows = (&of_fit(), &residuals[..]);
        robust_floor::widen(&mut fit, (&problem, recording), rows, (robust, weights));
    }
    let Some(after) = moved else {
        take_step(&mut fit, &[], &[]);
        return Ok(fit);
    };
    take_step(&mut fit, &changes, &[]);
    fit.cost = after.iter().map(|residual| residual * residual).sum();
    fit.residuals = after;
    Ok(fit)
}

/// Residuals of the device moved by these changes; none where it has no value at a row.
fn residuals_after(
    device: &Device,
    changes: &[(ParameterId, f64)],
    (recording, channels): (&Recording, &[Channel]),
    weights: &Weights,
) -> Option<Vec<f64>> {
    let mut moved = device.clone();
    move_device(&mut moved, changes);
    let problem = DeviceProblem::new(&moved, recording, channels, &[], weights).ok()?;
    Prepared::new(&problem).ok()?.residuals(&[]).ok()
}

/// Puts down the local sizes of the noise by channel and line.
fn take_sizes(
    problem: &DeviceProblem<'_>,
    recording: &Recording,
    found: &CorrelatedNoise,
    sizes: &mut Sizes,
) {
    for block in &problem.blocks {
        let own = (block.rows.iter().enumerate()).map(|(reading, &row)| {
            (
                row,
                found.sizes[block.first + reading * block.channel.width()],
            )
        });
        let own = own.filter_map(|(row, size)| Some((*recording.line.get(row)?, size)));
        let own: BTreeMap<u64, f64> = own.collect();
        if own.values().any(|size| *size != 1.0) {
            sizes.insert(block.channel, own);
        }
    }
}

/// Components of a covariance, as large for every parameter as that of the values that stay: a weighted fit's can be smaller.
fn no_narrower(components: Vec<Component>, plain: &Uncertainty) -> Vec<Component> {
    let variance =
        |k: usize| -> f64 { components.iter().map(|part| part.covariance[(k, k)]).sum() };
    let factor = (0..plain.columns.len()).fold(1.0, |most: f64, k| {
        most.max(plain.covariance[(k, k)] / variance(k).max(f64::MIN_POSITIVE))
    });
    let scaled = components.into_iter().map(|part| part.scaled(factor));
    scaled.collect()
}

/// Whether residuals after a step are those that the derivatives promise: what bends along it is below a part of the noise. Along a
/// valley, such as of axes that are nearly parallel, a step of a standard deviation can leave ten times the noise.
fn is_linear(derivatives: &Matrix, (before, after): (&[f64], &[f64]), step: &[f64]) -> bool {
    let promised = |row: usize| {
        let each = step.iter().enumerate();
        before[row]
            + each
                .map(|(column, own)| derivatives[(row, column)] * own)
                .sum::<f64>()
    };
    let bent: f64 = (after.iter().enumerate())
        .map(|(row, after)| (after - promised(row)).powi(2))
        .sum();
    let before: f64 = before.iter().map(|residual| residual.powi(2)).sum();
    bent <= MOST_BENT * before
}

/// Whether a drift is credible that leaves this of the readings without it. Lines that parameters can imitate are known to many times the
/// noise: unless one is sure, a step to them predicts other readings far worse than the fit does.
fn is_credible((before, after): (&[f64], &[f64]), p_value: f64) -> bool {
    let squares =
        |residuals: &[f64]| -> f64 { residuals.iter().map(|residual| residual.powi(2)).sum() };
    p_value < SURE_DRIFT || squares(after) <= MOST_RAISED * squares(before)
}

/// Moves a fit's device, its own parameters and others, and puts its intervals around the new values.
fn take_step(fit: &mut ParameterFit, own: &[(ParameterId, f64)], others: &[(ParameterId, f64)]) {
    move_device(&mut fit.device, own);
    move_device(&mut fit.device, others);
    for &index in &fit.fitted {
        let estimate = &mut fit.estimates[index];
        if let Some(value) = &mut estimate.value {
            *value = fit.parameters[index].value(&fit.device);
        }
    }
    fit.considered
        .widen(&mut fit.estimates, &fit.fitted, &fit.uncertainty, fit.noise);
}

/// The readings of each axis of each channel, in the order of the log; `fitted` are the parameters of the fit.
fn signals(problem: &DeviceProblem<'_>, fitted: &[ParameterId]) -> Vec<Signal> {
    let is_fitted_drift = |effect: usize| {
        let is_drift = |id: &ParameterId| match *id {
            ParameterId::Effect {
                effect: own,
                number,
            } => own == effect && problem.device.effects[own].fitted[number].is_drift,
            _ => false,
        };
        fitted.iter().any(is_drift)
    };
    let drifts = &|block: &Block, axis: usize| {
        let mut added = block.added.iter();
        added.any(|own| own.axis == axis && is_fitted_drift(own.effect))
    };
    let of_block = problem
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(group, block)| {
            let width = block.channel.width();
            let of_axis = move |axis: usize| Signal {
                group,
                rows: (0..block.rows.len())
                    .map(|reading| block.first + reading * width + axis)
                    .collect(),
                at: block.rows.clone(),
                has_drift: drifts(block, axis),
            };
            (0..width).map(of_axis)
        });
    of_block.collect()
}

/// The fit of step 2 where step 1 has moved: to the first order.
fn follow(
    mut fit: ParameterFit,
    moved: &[(ParameterId, f64)],
    (recording, channels): (&Cow<'_, Recording>, &[Channel]),
    weights: &Weights,
) -> Result<ParameterFit, CalibrationError> {
    if moved.is_empty() || fit.fitted.is_empty() {
        move_device(&mut fit.device, moved);
        return Ok(fit);
    }
    let failed = |source| wrap("noise of step 1", source);
    let own: Vec<ParameterId> = fit
        .fitted
        .iter()
        .map(|&index| fit.parameters[index])
        .collect();
    let others = moved.iter().map(|(parameter, _)| *parameter);
    let all: Vec<ParameterId> = own.iter().copied().chain(others).collect();
    let problem = DeviceProblem::new(&fit.device, recording, channels, &all, weights)?;
    let prepared = Prepared::new(&problem)?;
    let reduction = reduce(prepared.searched(), &problem.start()).map_err(failed)?;
    let columns: Vec<usize> = (0..all.len()).collect();
    let (first, second) = columns.split_at(own.len());
    let (follows, _) = sensitivity(&reduction, first, second).map_err(failed)?;
    let change = |row: usize| {
        let each = moved.iter().enumerate();
        each.map(|(column, (_, change))| follows[(row, column)] * change)
            .sum::<f64>()
    };
    let changes: Vec<(ParameterId, f64)> = own
        .iter()
        .enumerate()
        .map(|(row, &parameter)| (parameter, change(row)))
        .collect();
    take_step(&mut fit, &changes, moved);
    Ok(fit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_straight_where_residuals_are_what_the_derivatives_promise() {
        let derivatives = Matrix::from_fn(2, 1, |row, _| [2.0, -1.0][row]);
        let before = [1.0, 1.0];
        assert!(is_linear(&derivatives, (&before, &[2.0, 0.5]), &[0.5]));
        // squares of 2 before: 0.02 may bend
        assert!(is_linear(&derivatives, (&before, &[2.13, 0.5]), &[0.5]));
        assert!(!is_linear(&derivatives, (&before, &[2.15, 0.5]), &[0.5]));
        assert!(!is_linear(&derivatives, (&before, &[0.0, 1.5]), &[0.5]));
    }

    #[test]
    fn a_drift_that_is_not_sure_does_not_double_what_is_left() {
        let before = [1.0, -1.0];
        assert!(is_credible((&before, &[1.4, -1.4]), 0.2));
        assert!(!is_credible((&before, &[1.5, -1.4]), 0.2));
        assert!(is_credible((&before, &[9.0, -9.0]), 9e-4));
    }

    #[test]
    fn values_that_stay_have_no_smaller_intervals_than_before() {
        let component = |variance: f64| Component {
            covariance: Matrix::from_fn(2, 2, |a, b| if a == b { variance } else { 0.0 }),
            degrees_of_freedom: 9.0,
        };
        let mut plain = Uncertainty::none(10);
        plain.columns = vec![0, 1];
        plain.covariance = Matrix::from_fn(2, 2, |a, b| [[6.0, 0.0], [0.0, 1.0]][a][b]);
        let found = no_narrower(vec![component(1.0), component(2.0)], &plain);
        let variances: Vec<f64> = found.iter().map(|part| part.covariance[(0, 0)]).collect();
        assert_eq!(variances, [2.0, 4.0]);
        // wider ones stay
        let found = no_narrower(vec![component(9.0)], &plain);
        assert_eq!(found[0].covariance[(1, 1)], 9.0);
    }
}
