//! The fits of a whole device by least squares: two steps as in the paper, or all at once.

use std::borrow::Cow;
use std::collections::BTreeMap;

use haptical_identification::{NoiseScale, Problem, solve, uncertainty};
use haptical_model::{Device, ParameterId, Recording};

use crate::fit::profiled::profile;
use crate::fit::size;
use crate::problem::device_problem::values_of;
use crate::problem::form::Prepared;
use crate::problem::loads::Loads;
use crate::problem::some_rows::{some_of_long, spread_rows};
use crate::problem::weights::to_its_digits;
use crate::steps::fitted::{LEAST_FREEDOM, parameters_paid_by};
use crate::{
    CalibrationError, CalibrationMethod, Channel, DeviceProblem, FitRequest, FittedDevice, Options,
    ParameterFit, Starts, TransmissionFit, TransmissionTerms, Weighting, Weights,
    candidate_parameters, channel_residuals, channels, fit_parameters, fit_transmissions,
    rows_with_known_errors, with_curvature,
};

/// Rounds of re-estimating the channels' noise.
const WEIGHTING_ROUNDS: usize = 2;
/// Relative change of a channel's noise that is worth another fit.
const WEIGHTING_CHANGE: f64 = 0.1;

/// Rows and steps of the fit that looks at the columns.
const LOOKED_AT: usize = 240;
const MOST_STEPS: usize = 40;

/// Least squares, with the channels' noise re-estimated.
pub(crate) fn fit_squares(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let channels = channels(device, recording)?;
    if options.weighting == Weighting::Stated {
        let weights = Weights::stated(device, &channels);
        let mut fitted = fit_once(device, recording, &channels, &weights, options, None)?;
        fitted.weights = weights;
        return Ok(fitted);
    }
    let coarse = options.to_compare();
    let compare = |rows: &Recording| compared(device, (rows, recording), &channels, &coarse);
    let some = some_of_long(recording);
    let of_some = some.as_ref().and_then(|some| compare(some).ok());
    let is_of_some = of_some.is_some();
    let (mut fitted, is_weighed_again) = match of_some {
        Some(found) => found,
        None => compare(recording)?,
    };
    // the last one alone has to have its digits, and tries random places once more
    let is_rough = fitted.is_coarse() || is_weighed_again;
    if is_of_some || (is_rough && options.search.least_fall.is_none()) {
        let (weights, before) = (fitted.weights, Some(&fitted.device));
        fitted = fit_once(device, recording, &channels, &weights, options, before)?;
        fitted.weights = weights;
    }
    Ok(fitted)
}

/// Fits to `rows`, all of a recording or some of a long one, until the noise of its channels is known: its size shows on some rows,
/// and is taken from all. Besides, whether there was more than one round.
fn compared(
    device: &Device,
    (rows, recording): (&Recording, &Recording),
    channels: &[Channel],
    options: &Options,
) -> Result<(FittedDevice, bool), CalibrationError> {
    let mut weights = Weights::stated(device, channels);
    let mut fitted = fit_once(device, rows, channels, &weights, &options.to_weigh(), None)?;
    // random places are tried in the first round, and where a search finds no minimum
    let again = Options {
        starts: 0,
        ..options.clone()
    };
    let mut is_weighed_again = false;
    for _ in 0..WEIGHTING_ROUNDS {
        let estimated = Weights {
            factor: estimate_noise(&fitted, recording, channels, &weights)?,
            ..weights.clone()
        };
        if weights.change_to(&estimated) < WEIGHTING_CHANGE {
            break;
        }
        weights = estimated;
        is_weighed_again = true;
        let before = Some(&fitted.device);
        let fit = |options: &Options| fit_once(device, rows, channels, &weights, options, before);
        fitted = fit(&again).or_else(|_| fit(options))?;
    }
    fitted.weights = weights;
    Ok((fitted, is_weighed_again))
}

/// One fit with given weights; its searches begin at the values of `start`, those of a fit with other weights.
pub(crate) fn fit_once(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
    start: Option<&Device>,
) -> Result<FittedDevice, CalibrationError> {
    let fitted = after_step_one(device, recording, channels, weights, options)?;
    let Some((distant, rows)) = step_two(&fitted.device, recording, channels) else {
        return with_effects(fitted, recording, channels, options);
    };
    let is_joint = options.method == CalibrationMethod::Joint;
    let is_all = distant.len() == channels.len() && matches!(rows, Cow::Borrowed(_));
    // where no transmission is fitted, step 2 is the joint fit
    let is_last = !is_joint || (is_all && adds_nothing(&fitted));
    let (some, of_step) = match is_last {
        true => (None, options),
        false => (some_of_long(&rows), &options.to_compare()),
    };
    let rows = some.as_ref().unwrap_or(&rows);
    let kinematics =
        fit_kinematics_from(&fitted.device, rows, &distant, (weights, of_step), start)?;
    if is_last {
        return Ok(fitted.with_whole(kinematics));
    }
    let held = size::held_for_size(&kinematics, &fitted.device);
    let begin = match start {
        Some(start) if !kinematics.starts.replaced => &with_transmissions(start.clone(), &fitted),
        _ => &kinematics.device,
    };
    let mut fit = fit_jointly(
        &fitted,
        recording,
        channels,
        (weights, options),
        &held,
        begin,
    )?;
    if fit.starts.tried == 0 {
        // it began where step 2 had ended, which may have looked elsewhere
        fit.starts = Starts {
            doubt: fit.starts.doubt.or(kinematics.starts.doubt),
            doubt_that_remains: fit.starts.doubt_that_remains,
            ..kinematics.starts
        };
    }
    Ok(fitted.with_whole(fit))
}

/// Least squares to a part of the rows of another fit, from where that one ended and with its sizes of the noise. To be compared: its
/// numbers have few digits.
pub(crate) fn fit_from(
    device: &Device,
    recording: &Recording,
    options: &Options,
    whole: &FittedDevice,
) -> Result<FittedDevice, CalibrationError> {
    let channels = channels(device, recording)?;
    let options = &Options {
        starts: 0,
        ..options.to_compare()
    };
    // what the order of the rows says of single readings weighs in no fit
    let weights = &whole.weights.trusting();
    let is_joint = options.method == CalibrationMethod::Joint;
    let joint = whole.whole.as_ref().filter(|_| is_joint);
    let Some(joint) = joint.filter(|_| channels.iter().any(|channel| channel.sees_chain())) else {
        let start = Some(&whole.device);
        return fit_once(device, recording, &channels, weights, options, start);
    };
    let fitted = after_step_one(device, recording, &channels, weights, options)?;
    let begin = &with_transmissions(whole.device.clone(), &fitted);
    let forms = |fitted: &FittedDevice| -> Vec<(usize, TransmissionTerms)> {
        let steps = fitted.transmissions.iter();
        steps.map(|step| (step.joint, step.terms)).collect()
    };
    if forms(&fitted) == forms(whole) {
        let kept: Vec<ParameterId> = joint.fitted.iter().map(|&k| joint.parameters[k]).collect();
        let with = (weights, options);
        if let Some(device) = refitted(&fitted.device, recording, &channels, with, &kept, begin) {
            return Ok(FittedDevice { device, ..fitted });
        }
    }
    let held = size::held_for_size(joint, &fitted.device);
    let with = (weights, options);
    let fit = fit_jointly(&fitted, recording, &channels, with, &held, begin)?;
    Ok(fitted.with_whole(fit))
}

/// Residuals for each number of a fit from which most of the rows fix what all of them fix.
const PLENTY: usize = 20;

/// The device with these numbers of it fitted from where `begin` has them, none of them judged again. None where the rows are few, or do
/// not fix them.
fn refitted(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    (weights, options): (&Weights, &Options),
    kept: &[ParameterId],
    begin: &Device,
) -> Option<Device> {
    let mut problem = DeviceProblem::new(device, recording, channels, kept, weights).ok()?;
    problem.loads = Loads::new(begin, recording).ok()?;
    if kept.is_empty() || problem.residual_count() < PLENTY * kept.len() {
        return None;
    }
    let prepared = Prepared::new(&problem).ok()?;
    let (start, all) = (
        values_of(kept, begin),
        (0..kept.len()).collect::<Vec<usize>>(),
    );
    let fit = solve(prepared.searched(), &start, &all, &options.search).ok()?;
    let found = problem.device_with(&fit.parameters);
    let spread = uncertainty(&fit.reduction, &all, fit.cost, NoiseScale::Stated).ok()?;
    // few rows may be all that shows one of them
    let is_fixed = |(place, parameter): (usize, &ParameterId)| {
        let most = options.rules.weak_share * parameter.plausible_size(device);
        spread.standard_deviation(place) <= most
    };
    let is_sound = fit.convergence.was_successful()
        && kept.iter().enumerate().all(is_fixed)
        && size::collapsed(device, &found, recording, channels).is_none();
    is_sound.then_some(found)
}

/// Step 1 alone.
fn after_step_one(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let (device, transmissions) = fit_transmissions(device, recording, channels, weights, options)?;
    Ok(FittedDevice {
        device,
        transmissions,
        whole: None,
        weights: weights.clone(),
        robust: None,
    })
}

/// Whether the joint fit has the parameters of step 2 alone.
fn adds_nothing(fitted: &FittedDevice) -> bool {
    let (parameters, unsupported) = joint_candidates(&fitted.device, &fitted.transmissions);
    unsupported.is_empty() && parameters == candidate_parameters(&fitted.device)
}

/// Kinematics and transmissions at once, from the values of `begin`; what is held for the device's size stays at the device's own value,
/// wherever an earlier fit had it.
fn fit_jointly(
    fitted: &FittedDevice,
    recording: &Recording,
    channels: &[Channel],
    (weights, options): (&Weights, &Options),
    held: &[ParameterId],
    begin: &Device,
) -> Result<ParameterFit, CalibrationError> {
    let (mut parameters, unsupported) = joint_candidates(&fitted.device, &fitted.transmissions);
    parameters.retain(|parameter| !held.contains(parameter));
    let candidates = (parameters, unsupported);
    let with = (weights, options);
    fit_candidates(fitted, recording, channels, with, candidates, Some(begin))
}

/// A fit of candidates and of terms that step 1 found unsupported, from where `begin` has them.
fn fit_candidates(
    fitted: &FittedDevice,
    recording: &Recording,
    channels: &[Channel],
    (weights, options): (&Weights, &Options),
    (mut parameters, unsupported): (Vec<ParameterId>, Vec<ParameterId>),
    begin: Option<&Device>,
) -> Result<ParameterFit, CalibrationError> {
    let first = parameters.len();
    parameters.extend(unsupported);
    let unsupported: Vec<usize> = (first..parameters.len()).collect();
    fit_parameters(&FitRequest {
        what: "joint identification",
        device: &fitted.device,
        recording,
        channels,
        parameters: &parameters,
        unsupported: &unsupported,
        weights,
        options,
        start: begin,
        yielded: begin,
    })
}

/// A device with the transmissions of step 1, whose forms another fit may have chosen otherwise.
fn with_transmissions(mut device: Device, fitted: &FittedDevice) -> Device {
    for step in &fitted.transmissions {
        let error = &fitted.device.joints[step.joint].transmission_error;
        device.joints[step.joint]
            .transmission_error
            .clone_from(error);
    }
    device
}

/// Transmissions and effects together, where nothing sees the chain: an effect may be of several joints. What step 1 found
/// where the device has no effect to be fitted.
fn with_effects(
    fitted: FittedDevice,
    recording: &Recording,
    channels: &[Channel],
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let (mut parameters, mut unsupported) = joint_candidates(&fitted.device, &fitted.transmissions);
    let is_shown = |parameter: &ParameterId| {
        matches!(
            parameter,
            ParameterId::Transmission { .. } | ParameterId::Effect { .. }
        )
    };
    parameters.retain(is_shown);
    unsupported.retain(is_shown);
    let is_effect = |parameter: &ParameterId| matches!(parameter, ParameterId::Effect { .. });
    if !parameters.iter().any(is_effect) {
        return Ok(fitted);
    }
    let candidates = (parameters, unsupported);
    let with = (&fitted.weights, options);
    let fit = fit_candidates(&fitted, recording, channels, with, candidates, None)?;
    Ok(fitted.with_whole(fit))
}

/// Refuses a log of which a fit to a part shows that a joint's column is turned or in another's place.
///
/// What shows without a fit, [`crate::check_rig`] refuses; a small joint's turned column leaves less than the deviations of
/// the device file do.
///
/// # Errors
/// [`CalibrationError::MistakenColumns`] alone: what else a fit refuses, the fit itself says.
pub fn check_columns(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let part = recording.select(&spread_rows(recording.len(), LOOKED_AT));
    let channels = channels(device, &part)?;
    let mut options = Options {
        method: CalibrationMethod::TwoStep,
        starts: 0,
        unfinished: true,
        ..Options::default()
    };
    options.search.max_iterations = options.search.max_iterations.min(MOST_STEPS);
    let weights = Weights::stated(device, &channels);
    match fit_once(device, &part, &channels, &weights, &options, None) {
        Err(error @ CalibrationError::MistakenColumns { .. }) => Err(error),
        _ => Ok(()),
    }
}

/// Channels and rows of step 2: what sees the chain, none where nothing does, and the rows whose transmission errors
/// are known, unless they are less than half.
pub(crate) fn step_two<'r>(
    device: &Device,
    recording: &'r Recording,
    channels: &[Channel],
) -> Option<(Vec<Channel>, Cow<'r, Recording>)> {
    let channels = channels.iter().copied();
    let distant: Vec<Channel> = channels.filter(|channel| channel.sees_chain()).collect();
    if distant.is_empty() {
        return None;
    }
    let within = rows_with_known_errors(device, recording);
    let are_some = within.len() < recording.len() && 2 * within.len() >= recording.len();
    let rows = match are_some {
        true => Cow::Owned(recording.select(&within)),
        false => Cow::Borrowed(recording),
    };
    Some((distant, rows))
}

/// Looks at the intervals of the last fit where the problem is no longer straight: over what was held, and over what
/// was fitted.
pub(crate) fn straighten(
    mut fitted: FittedDevice,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let channels = channels(&fitted.device, recording)?;
    let steps = match options.method {
        CalibrationMethod::Joint => Some((channels, Cow::Borrowed(recording))),
        CalibrationMethod::TwoStep => step_two(&fitted.device, recording, &channels),
    };
    if let (Some(whole), Some((channels, rows))) = (fitted.whole.take(), steps) {
        let mut whole = with_curvature(whole, &rows, &channels, &fitted.weights)?;
        profile(&mut whole, &rows, &channels, &fitted.weights, options);
        fitted.whole = Some(whole);
    }
    Ok(fitted)
}

/// Step 2: the kinematic parameters from distances (or positions) at corrected joint angles.
///
/// # Errors
/// [`CalibrationError`].
pub fn fit_kinematics(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
) -> Result<ParameterFit, CalibrationError> {
    fit_kinematics_from(device, recording, channels, (weights, options), None)
}

fn fit_kinematics_from(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    (weights, options): (&Weights, &Options),
    start: Option<&Device>,
) -> Result<ParameterFit, CalibrationError> {
    let mut parameters = candidate_parameters(device);
    let held = size::held_for_scale(device, recording, channels);
    parameters.retain(|parameter| !held.contains(parameter));
    fit_parameters(&FitRequest {
        what: "kinematic parameters",
        device,
        recording,
        channels,
        parameters: &parameters,
        unsupported: &[],
        weights,
        options,
        start,
        yielded: start,
    })
}

/// Kinematics and every transmission: the terms that step 1 chose, and equation (1) of capstans
/// without an external encoder, as far as the distances show it. Besides, the terms that step 1 found unsupported.
fn joint_candidates(
    device: &Device,
    transmissions: &[TransmissionFit],
) -> (Vec<ParameterId>, Vec<ParameterId>) {
    let mut parameters = candidate_parameters(device);
    let mut unsupported = Vec::new();
    for (joint, description) in device.joints.iter().enumerate() {
        let step = transmissions.iter().find(|fit| fit.joint == joint);
        let terms = match step {
            Some(fit) => fit.terms,
            None => match description.transmission {
                haptical_model::TransmissionKind::Capstan => TransmissionTerms::Capstan,
                _ => TransmissionTerms::None,
            },
        };
        let own = |indices: Vec<usize>| {
            let there = |index: &usize| *index < description.error_parameter_count();
            let indices = indices.into_iter().filter(there);
            indices.map(move |index| ParameterId::Transmission { joint, index })
        };
        parameters.extend(own(terms.free_parameters()));
        if step.is_some() {
            unsupported.extend(own(terms.unsupported_parameters(description.transmission)));
        }
    }
    (parameters, unsupported)
}

/// Each channel's residual size over its stated noise: sqrt(RSS / (m - p)) over the stated rms, with
/// m its readings and p the parameters that they pay for ([`ParameterFit::channel_parameters`]). A
/// channel with too few degrees of freedom keeps the size that it had.
fn estimate_noise(
    fitted: &FittedDevice,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
) -> Result<BTreeMap<Channel, f64>, CalibrationError> {
    let residuals =
        channel_residuals(&fitted.device, &fitted.device, recording, channels, weights)?;
    Ok(residuals
        .iter()
        .filter_map(|channel| {
            let readings = channel.residuals.len() as f64;
            let freedom = readings - parameters_paid_by(fitted, channel.channel);
            if freedom < LEAST_FREEDOM || channel.noise_floor == 0.0 {
                let factor = weights.factor.get(&channel.channel)?;
                return Some((channel.channel, *factor));
            }
            let deviation = channel.rms()? * (readings / freedom).sqrt();
            // A channel that is fitted exactly keeps a little weight: its noise is not zero.
            let factor = (deviation / channel.noise_floor).max(1e-3);
            Some((channel.channel, to_its_digits(factor)))
        })
        .collect())
}
