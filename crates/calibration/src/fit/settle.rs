//! Torques at the angles to which a device yields: they need its compliances, which need the torques.

use haptical_model::ParameterId;

use crate::fit::request::FitRequest;
use crate::{CalibrationError, ParameterFit};

/// Most repetitions of a fit: each leaves some hundredths of the error before, by which gravity's torque changes
/// as the joint yields.
const MOST_SETTLINGS: usize = 3;
/// A compliance has settled where it moves by less than this part of its standard deviation.
const SETTLED: f64 = 0.01;

/// Repeats a fit of compliances with the torques at the angles that it found.
///
/// # Errors
/// Those of the fit.
pub(crate) fn settle(
    request: &FitRequest<'_>,
    mut fit: ParameterFit,
) -> Result<ParameterFit, CalibrationError> {
    // whose compliances decided at which angles the fit's torques were taken
    let mut taken_at = request.yielded.unwrap_or(request.device).clone();
    for _ in 0..MOST_SETTLINGS {
        let is_settled = compliances(&fit).all(|(parameter, sd)| {
            let moved = parameter.value(&fit.device) - parameter.value(&taken_at);
            moved.abs() <= SETTLED * sd
        });
        if is_settled || !yields(request, &fit) || !fit.convergence.was_successful() {
            break;
        }
        let again = FitRequest {
            start: Some(&fit.device),
            yielded: Some(&fit.device),
            ..*request
        };
        let next = again.fit()?;
        if !next.convergence.was_successful() {
            break;
        }
        taken_at = fit.device;
        fit = ParameterFit {
            iterations: fit.iterations + next.iterations,
            starts: fit.starts,
            // judged where the fit began, as others are
            nominal_identifiability: fit.nominal_identifiability,
            ..next
        };
    }
    Ok(fit)
}

/// Whether a compliance was fitted to a torque that was not logged.
fn yields(request: &FitRequest<'_>, fit: &ParameterFit) -> bool {
    let is_logged = |joint: usize| {
        let column = request
            .recording
            .torque_nm
            .get(joint)
            .and_then(Option::as_ref);
        column.is_some_and(|column| column.iter().all(|torque| torque.is_finite()))
    };
    compliances(fit).any(|(parameter, _)| match *parameter {
        ParameterId::Compliance { joint } => !is_logged(joint),
        _ => false,
    })
}

/// Fitted compliances and their standard deviations.
fn compliances(fit: &ParameterFit) -> impl Iterator<Item = (&ParameterId, f64)> {
    fit.fitted.iter().filter_map(|&index| {
        let parameter = &fit.parameters[index];
        let sd = fit.estimates[index].standard_deviation?;
        matches!(parameter, ParameterId::Compliance { .. }).then_some((parameter, sd))
    })
}
