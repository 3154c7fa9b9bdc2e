//! Refit with joint offsets beyond a machined device's tolerance, where the residual exceeds noise.

use haptical_identification::Status;
use haptical_model::{Parameter, ParameterId};

use crate::fit::implausible::implausible_links;
use crate::fit::request::FitRequest;
use crate::{CalibrationError, ParameterFit};

/// How far the offset of an encoder may be off that was mounted by eye \[rad\]: two to three degrees of a humanoid's
/// joints are usual.
const MOUNTED_RAD: f64 = 0.08;
/// Standard deviations of chi-square by which a residual is more than noise.
const ABOVE_NOISE: f64 = 4.0;

/// Fits again with joint offsets that may be farther off, where weak ones are held, the residual is more than noise,
/// and they explain what is left.
///
/// A parameter that the recording fixes no better than to half of its plausible size is held, which keeps an offset
/// at 0 that is 4 degrees if it is known to 1 degree only. What somebody stated of an offset's size stays.
///
/// # Errors
/// Those of the fit.
pub(crate) fn widen_offsets(
    request: &FitRequest<'_>,
    fit: ParameterFit,
) -> Result<ParameterFit, CalibrationError> {
    let mut wide = request.device.clone();
    let mut is_asked = false;
    for (&parameter, status) in request.parameters.iter().zip(&fit.identifiability.statuses) {
        if let (
            ParameterId::Link {
                row,
                parameter: number @ Parameter::Theta,
            },
            Status::Weak { .. },
        ) = (parameter, status)
            && wide.deviation(row, number).is_none()
        {
            wide.deviations.insert((row, number), MOUNTED_RAD);
            is_asked = true;
        }
    }
    let freedom = fit.residuals.len() as f64 - fit.fitted.len() as f64;
    let is_above = fit.cost > freedom + ABOVE_NOISE * (2.0 * freedom).sqrt();
    if !is_asked || freedom < 1.0 || !is_above {
        return Ok(fit);
    }
    let again = FitRequest {
        device: &wide,
        start: Some(&fit.device),
        yielded: Some(&fit.device),
        ..*request
    };
    let Ok(mut wider) = again.fit() else {
        return Ok(fit);
    };
    let left = wider.residuals.len() as f64 - wider.fitted.len() as f64;
    let noise = wider.cost / left.max(1.0);
    let more = (wider.fitted.len() as f64 - fit.fitted.len() as f64).max(1.0);
    let is_explained = fit.cost - wider.cost > noise * (more + ABOVE_NOISE * (2.0 * more).sqrt());
    let is_plausible =
        implausible_links(&wide, &wider).len() <= implausible_links(request.device, &fit).len();
    if wider.convergence.was_successful() && left >= 1.0 && is_explained && is_plausible {
        // the sizes are of this fit alone
        wider
            .device
            .deviations
            .clone_from(&request.device.deviations);
        wider.starts = fit.starts;
        return Ok(wider);
    }
    Ok(fit)
}
