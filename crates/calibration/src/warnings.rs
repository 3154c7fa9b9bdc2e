//! Things that a user should know of a recording and of a result, in sentences.

use haptical_model::{Device, Recording};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    CalibrationMethod, Channel, ChannelReport, FittedDevice, ParameterFit, Starts, sufficiency,
};

/// What a recording lacks for this device.
pub(crate) fn of_recording(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Vec<String> {
    let mut warnings = Vec::new();
    let ignored = recording.position_m.is_some() || recording.cable_m.iter().any(Option::is_some);
    if !device.has_links() && ignored {
        warnings.push(
            "the device has no [[link]] rows: positions and distances are ignored, only \
             transmissions are calibrated"
                .to_owned(),
        );
    }
    if let Some(held) = crate::scale::held_length(device, channels) {
        warnings.push(format!(
            "touches of unknown points and planes do not tell a device from a larger one: {} is held, and all \
             other lengths are in proportion to it; give the distance of two points ([[contact_pair]]), a cable \
             or a tracker's position",
            held.name(device)
        ));
    }
    if device.has_links()
        && device.cables.is_empty()
        && recording.cable_m.iter().any(Option::is_some)
    {
        warnings.push(
            "the device has no [cable_encoder]: cable_m is taken as the distance from frame (-1)'s \
             origin, with noise of 0.1 mm until the residuals show it; add [cable_encoder] with \
             distance_sd_m"
                .to_owned(),
        );
    }
    let resting = sufficiency::resting_joints(recording);
    if !resting.is_empty() {
        let numbers: Vec<String> = resting
            .iter()
            .map(|joint| (joint + 1).to_string())
            .collect();
        warnings.push(format!(
            "joint {} does not move in this recording: its parameters merge with its neighbours'",
            numbers.join(", ")
        ));
    }
    for (joint, description) in device.joints.iter().enumerate() {
        let driven = description.transmission != haptical_model::TransmissionKind::Direct;
        if driven && !channels.contains(&Channel::Output { joint }) {
            warnings.push(format!(
                "joint {} has a transmission but no out{} column: its error can only be seen \
                 through the distances, as far as they show it",
                joint + 1,
                joint + 1
            ));
        }
    }
    warnings
}

/// Deviation, in plausible sizes, beyond which a value is more likely a wrong unit, a swapped column
/// or a mirror image of the device than the device: half a decimetre, a fifth of a radian.
const IMPLAUSIBLE: f64 = 10.0;
/// Residual over noise floor beyond which more than noise is left; too short a log to extrapolate
/// from stays below.
const ABOVE_FLOOR: f64 = 1.5;

/// Chance that noise alone is called more than noise.
const FALSE_ALARM: f64 = 1e-3;

/// Residual over noise floor beyond which more than noise is left among so many readings: of few, chance alone
/// reaches more (chi-square over its degrees of freedom).
fn above_floor(readings: usize) -> f64 {
    let freedom = readings.max(1) as f64;
    let largest = ChiSquared::new(freedom).map(|chi| chi.inverse_cdf(1.0 - FALSE_ALARM));
    largest.map_or(ABOVE_FLOOR, |largest| {
        ABOVE_FLOOR.max((largest / freedom).sqrt())
    })
}

/// What searches from other places said.
fn of_search(starts: &Starts) -> Vec<String> {
    let mut warnings = Vec::new();
    if starts.replaced {
        warnings.push(format!(
            "the search from the device file's values ended at another minimum ({}); the values are those of the \
             best of {} random starts, which {} of them reached",
            starts.doubt.as_deref().unwrap_or("doubted"),
            starts.tried,
            starts.reached_best
        ));
    }
    if starts.rivals > 0 {
        warnings.push(format!(
            "{} of {} random starts ended at other plausible values that fit as well: this recording does not tell \
             which are the device's; record more poses, farther apart",
            starts.rivals, starts.tried
        ));
    }
    if starts.tried > 0
        && !starts.replaced
        && let Some(doubt) = &starts.doubt_that_remains
    {
        warnings.push(format!(
            "{doubt}; none of {} random starts found a better minimum, so the cause is rather the model or the \
             readings than the search",
            starts.tried
        ));
    }
    warnings
}

/// What a result has that no good result has.
pub(crate) fn of_result(
    nominal: &Device,
    fitted: &FittedDevice,
    channels: &[ChannelReport],
    method: CalibrationMethod,
) -> Vec<String> {
    let mut warnings = Vec::new();
    for report in channels.iter().filter(|report| report.outside_range > 0) {
        warnings.push(format!(
            "{}: {} held-out readings lie outside the range that a polynomial was fitted on and \
             were left out",
            report.channel, report.outside_range
        ));
    }
    if let Some(robust) = &fitted.robust {
        if !robust.settled {
            warnings.push(format!(
                "the weights of the {} loss still moved after {} fits: look at the outliers before you \
                 trust the values",
                robust.loss, robust.rounds
            ));
        }
        if !robust.outliers.is_empty() {
            warnings.push(format!(
                "readings farther from the model than noise explains: {}; the {} loss was used, so they \
                 count little or nothing. They are listed as outliers: look whether a sensor failed there or \
                 the model lacks an effect",
                robust.outliers.len(),
                robust.loss
            ));
        }
    }
    let fits: Vec<&ParameterFit> = match &fitted.whole {
        Some(whole) if method == CalibrationMethod::Joint => vec![whole],
        whole => {
            let steps = fitted
                .transmissions
                .iter()
                .filter_map(|step| step.fit.as_ref());
            whole.iter().chain(steps).collect()
        }
    };
    if let Some(whole) = &fitted.whole {
        warnings.extend(of_search(&whole.starts));
    }
    let implausible: Vec<String> = fits
        .iter()
        .flat_map(|fit| implausible(nominal, fit))
        .collect();
    if !implausible.is_empty() {
        warnings.push(format!(
            "implausible deviations, over {IMPLAUSIBLE} times what devices show: {}; check units, \
             signs and order of the columns, and that the device file describes this device (the fit \
             may have found a mirror image of it)",
            implausible.join(", ")
        ));
    }
    for report in channels {
        if report.rms_after_good > above_floor(report.readings) * report.noise_floor {
            warnings.push(format!(
                "{}: the residual left, {:.3e} {}, is {:.1} times the noise floor: the model lacks \
                 an effect, rows are disturbed, or the stated noise is too small; look at the \
                 residual figures for what it depends on",
                report.channel,
                report.rms_after_good,
                report.unit,
                report.rms_after_good / report.noise_floor
            ));
        }
    }
    if method == CalibrationMethod::TwoStep
        && fitted.whole.is_some()
        && !fitted.transmissions.is_empty()
    {
        warnings.push(
            "the intervals of the kinematic parameters take step 1 as exact and are too short for \
             it; those of the joint method are not"
                .to_owned(),
        );
    }
    warnings
}

/// Fitted parameters that moved by more than is plausible, with the move.
fn implausible(nominal: &Device, fit: &ParameterFit) -> Vec<String> {
    fit.fitted
        .iter()
        .filter_map(|&position| {
            let parameter = fit.parameters[position];
            if let haptical_model::ParameterId::Surrounding(_) = parameter {
                // nobody knows beforehand where these are
                return None;
            }
            let before = match parameter {
                haptical_model::ParameterId::Link { .. } => parameter.value(nominal),
                // a transmission's nominal error is zero, whatever form it now has
                _ => 0.0,
            };
            let moved = parameter.value(&fit.device) - before;
            let device = &fit.device;
            (moved.abs() > IMPLAUSIBLE * parameter.plausible_size(device)).then(|| {
                format!(
                    "{} by {moved:.3} {}",
                    parameter.name(device),
                    parameter.unit(device)
                )
            })
        })
        .collect()
}
