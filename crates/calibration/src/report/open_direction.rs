//! Directions in which the parameters may move without any effect on the recording.

use haptical_identification::Status;
use haptical_model::ParameterId;

use crate::ParameterFit;

/// A parameter that nothing fixes, with the change of each other one that undoes its effect on the recording.
pub(crate) struct OpenDirection {
    /// Name of the parameter.
    pub(crate) name: String,
    /// Its plausible size.
    pub(crate) size: f64,
    /// Changes for a unit change of it, its own first.
    pub(crate) terms: Vec<(ParameterId, f64)>,
}

/// One direction for each invisible or dependent candidate of a fit.
pub(crate) fn open_directions(fit: &ParameterFit) -> Vec<OpenDirection> {
    let statuses = fit.identifiability.statuses.iter().enumerate();
    let directions = statuses.filter_map(|(index, status)| {
        let parameter = fit.parameters[index];
        let mut terms = vec![(parameter, 1.0)];
        match status {
            Status::Invisible => {}
            Status::Dependent { combination } => {
                let undo = combination.iter();
                terms.extend(undo.map(|term| (fit.parameters[term.parameter], -term.coefficient)));
            }
            Status::Identifiable { .. } | Status::Weak { .. } => return None,
        }
        Some(OpenDirection {
            name: parameter.name(&fit.device),
            size: parameter.plausible_size(&fit.device),
            terms,
        })
    });
    directions.collect()
}
