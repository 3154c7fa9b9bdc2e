//! Fits a whole device to the rows that it may see: two steps as in the paper, or all at once.

use std::collections::BTreeMap;

use haptical_identification::Loss;
use haptical_model::{Device, ParameterId, Recording};

use crate::fit::{Task, fit_task};
use crate::profiled::profile;
use crate::{
    CalibrationError, CalibrationMethod, Channel, LossChoice, Options, ParameterFit, Robustness,
    Starts, TransmissionFit, TransmissionTerms, Weighting, Weights, automatic_loss,
    candidate_parameters, channel_residuals, channels, fit_parameters, fit_transmissions, robust,
    rows_with_known_errors, scale, with_step_one_noise,
};

/// A fitted device with the fits that made it.
#[derive(Debug, Clone)]
pub struct FittedDevice {
    /// The device.
    pub device: Device,
    /// Step 1.
    pub transmissions: Vec<TransmissionFit>,
    /// Step 2, or the joint fit; none for a device without links.
    pub whole: Option<ParameterFit>,
    /// Noise sizes that the last fit used.
    pub weights: Weights,
    /// What a robust loss made of the readings; none for least squares.
    pub robust: Option<Robustness>,
}

/// Rounds of re-estimating the channels' noise.
const WEIGHTING_ROUNDS: usize = 2;
/// Relative change of a channel's noise that is worth another fit.
const WEIGHTING_CHANGE: f64 = 0.1;

/// Fits the device to all rows of a recording.
///
/// # Errors
/// [`CalibrationError`].
pub fn fit_device(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let device = &crate::prepare_device(device, recording)?;
    match options.loss {
        LossChoice::Fixed(Loss::Squares) => fit_squares(device, recording, options),
        LossChoice::Fixed(loss) => robust::fit(device, recording, options, loss),
        LossChoice::Auto => {
            let plain = fit_squares(device, recording, options);
            automatic_loss::automatic(device, recording, options, plain)
        }
    }
}

/// Least squares, with the channels' noise re-estimated.
fn fit_squares(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let channels = channels(device, recording)?;
    let mut weights = Weights::stated(device, &channels);
    let mut fitted = fit_once(device, recording, &channels, &weights, options)?;
    if options.weighting == Weighting::Estimated {
        for _ in 0..WEIGHTING_ROUNDS {
            let estimated = estimate_noise(&fitted, recording, &channels, &weights)?;
            let change = estimated
                .iter()
                .map(|(channel, factor)| {
                    let before = weights.factor.get(channel).copied().unwrap_or(1.0);
                    (factor / before).ln().abs()
                })
                .fold(0.0, f64::max);
            if change < WEIGHTING_CHANGE {
                break;
            }
            weights.factor = estimated;
            fitted = fit_once(device, recording, &channels, &weights, options)?;
        }
    }
    fitted.weights = weights;
    Ok(fitted)
}

pub(crate) fn fit_once(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let (compensated, transmissions) =
        fit_transmissions(device, recording, channels, weights, options)?;
    let fitted = FittedDevice {
        device: compensated,
        transmissions,
        whole: None,
        weights: weights.clone(),
        robust: None,
    };
    let distant: Vec<Channel> = channels
        .iter()
        .copied()
        .filter(|channel| channel.sees_chain())
        .collect();
    if distant.is_empty() {
        return Ok(fitted);
    }
    let inside = rows_of_step_two(&fitted.device, recording);
    let kinematics = fit_kinematics(
        &fitted.device,
        inside.as_ref().unwrap_or(recording),
        &distant,
        weights,
        options,
    )?;
    let whole = match options.method {
        CalibrationMethod::TwoStep => kinematics,
        CalibrationMethod::Joint => {
            // what the fit of both holds stays at the device's own value, wherever step 2 had it
            let mut parameters = joint_candidates(&fitted.device, &fitted.transmissions);
            let held = scale::held_by(&kinematics, &fitted.device);
            parameters.retain(|parameter| !held.contains(parameter));
            let mut fit = fit_task(&Task {
                what: "joint identification",
                device: &fitted.device,
                recording,
                channels,
                parameters: &parameters,
                weights,
                options,
                from: Some(&kinematics.device),
                loads_of: None,
            })?;
            if fit.starts.tried == 0 {
                // it began where step 2 had ended, which may have looked elsewhere
                fit.starts = Starts {
                    doubt: fit.starts.doubt.or(kinematics.starts.doubt),
                    doubt_that_remains: fit.starts.doubt_that_remains,
                    ..kinematics.starts
                };
            }
            fit
        }
    };
    Ok(FittedDevice {
        device: whole.device.clone(),
        whole: Some(whole),
        ..fitted
    })
}

/// The rows whose transmission errors are known, unless they are all or less than half.
fn rows_of_step_two(device: &Device, recording: &Recording) -> Option<Recording> {
    let within = rows_with_known_errors(device, recording);
    let are_some = within.len() < recording.len() && 2 * within.len() >= recording.len();
    are_some.then(|| recording.select(&within))
}

/// Gives the kinematic fit of two steps the noise of the first.
pub(crate) fn add_step_one_noise(
    mut fitted: FittedDevice,
    channels: &[Channel],
    recording: &Recording,
) -> Result<FittedDevice, CalibrationError> {
    let Some(whole) = fitted.whole.take() else {
        return Ok(fitted);
    };
    let distant: Vec<Channel> = channels
        .iter()
        .copied()
        .filter(|channel| channel.sees_chain())
        .collect();
    let inside = rows_of_step_two(&fitted.device, recording);
    let rows = inside.as_ref().unwrap_or(recording);
    let (steps, weights) = (&fitted.transmissions, &fitted.weights);
    fitted.whole = Some(with_step_one_noise(whole, steps, rows, &distant, weights)?);
    Ok(fitted)
}

/// Looks at the intervals of the last fit where they are no longer straight.
pub(crate) fn profile_whole(
    fitted: &mut FittedDevice,
    recording: &Recording,
    options: &Options,
) -> Result<(), CalibrationError> {
    let channels = channels(&fitted.device, recording)?;
    let Some(whole) = &mut fitted.whole else {
        return Ok(());
    };
    if options.method == CalibrationMethod::Joint {
        profile(whole, recording, &channels, &fitted.weights, options);
        return Ok(());
    }
    let channels = channels.iter().copied();
    let distant: Vec<Channel> = channels.filter(|channel| channel.sees_chain()).collect();
    let inside = rows_of_step_two(&fitted.device, recording);
    let rows = inside.as_ref().unwrap_or(recording);
    profile(whole, rows, &distant, &fitted.weights, options);
    Ok(())
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
    let mut parameters = candidate_parameters(device);
    let held = scale::held_for_scale(device, recording, channels);
    parameters.retain(|parameter| !held.contains(parameter));
    let what = "kinematic parameters";
    fit_parameters(
        what,
        device,
        recording,
        channels,
        &parameters,
        weights,
        options,
    )
}

/// Kinematics and every transmission: the terms that step 1 chose, and equation (1) of capstans
/// without an external encoder, as far as the distances show it.
fn joint_candidates(device: &Device, transmissions: &[TransmissionFit]) -> Vec<ParameterId> {
    let mut parameters = candidate_parameters(device);
    for (joint, description) in device.joints.iter().enumerate() {
        let terms = match transmissions.iter().find(|fit| fit.joint == joint) {
            Some(fit) => fit.terms,
            None => match description.transmission {
                haptical_model::TransmissionKind::Capstan => TransmissionTerms::Capstan,
                _ => TransmissionTerms::None,
            },
        };
        parameters.extend(
            terms
                .free_parameters()
                .into_iter()
                .filter(|&index| index < description.error_parameter_count())
                .map(|index| ParameterId::Transmission { joint, index }),
        );
    }
    parameters
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
            Some((channel.channel, (deviation / channel.noise_floor).max(1e-3)))
        })
        .collect())
}

/// Degrees of freedom from which on a channel's residuals say what its noise is: one or two may be zero by chance,
/// and its readings would count as exact.
pub(crate) const LEAST_FREEDOM: f64 = 4.0;

/// The last fit that saw the channel decides: the joint one, or in two steps the transmission's own.
pub(crate) fn parameters_paid_by(fitted: &FittedDevice, channel: Channel) -> f64 {
    let of = |fit: &ParameterFit| fit.channel_parameters.get(&channel).copied();
    let own = || {
        let fits = fitted.transmissions.iter();
        fits.filter_map(|fit| fit.fit.as_ref()).find_map(of)
    };
    fitted
        .whole
        .as_ref()
        .and_then(of)
        .or_else(own)
        .unwrap_or(0.0)
}
