//! The fit of chosen parameters, with further starts and refits where the first one is doubted.

use crate::CalibrationError;
use crate::fit::parameter_fit::ParameterFit;
use crate::fit::request::FitRequest;
use crate::fit::settle::settle;
use crate::fit::wider::widen_offsets;
use crate::fit::{mistakes, multi_start, size};

/// Fits the parameters of a request to its channels.
///
/// Parameters that are invisible, dependent or weak are held at the device's values and say so in
/// their status. The set is decided at the nominal device and decided again at the solution, because
/// a geometry that is special by design (parallel, intersecting) is not special once it deviates.
/// A search that fails, or ends where no good fit ends, is tried again from random places
/// ([`crate::Options::starts`]).
///
/// # Errors
/// [`CalibrationError`] where nothing can be fitted or no search ends at a minimum.
pub fn fit_parameters(request: &FitRequest<'_>) -> Result<ParameterFit, CalibrationError> {
    let (what, device, options) = (request.what, request.device, request.options);
    let fit = multi_start::improve(request, request.fit()?)?;
    mistakes::refuse(request, &fit)?;
    let fit = settle(request, fit)?;
    let fit = widen_offsets(request, fit)?;
    if !fit.convergence.was_successful() && !options.unfinished {
        return Err(CalibrationError::NotConverged {
            what: what.to_owned(),
            reason: fit.convergence.to_string(),
        });
    }
    if let Some(share) = size::collapsed(device, &fit.device, request.recording, request.channels) {
        return Err(CalibrationError::Collapsed {
            what: what.to_owned(),
            share,
        });
    }
    Ok(fit)
}
