//! Which parameters a calibration may free, and which it prefers to keep.

use haptical_identification::ParameterInfo;
use haptical_model::{Device, LinkParameter, ParameterId};

/// Two successive axes within this angle count as parallel, so that Hayati's angle is offered.
/// (Judd & Knasinski and Hayati & Mirmirani 1985 advise it where a twist of a few degrees would
/// move the common normal by more than the arm is long.)
const PARALLEL_RAD: f64 = 0.02;

/// The Denavit-Hartenberg parameters of all rows; Hayati's angle only on rows 1 to n - 1 whose axis
/// is parallel to the next one.
pub fn candidate_parameters(device: &Device) -> Vec<ParameterId> {
    let last = device.links.len().saturating_sub(1);
    device
        .link_parameters(true)
        .into_iter()
        .filter(|parameter| match parameter {
            ParameterId::Link {
                row,
                parameter: LinkParameter::Beta,
            } => {
                *row > 0
                    && *row < last
                    && device.links[*row].alpha_rad.sin().abs() < PARALLEL_RAD.sin()
            }
            _ => true,
        })
        .collect()
}

/// Positions of `parameters` by preference, dearest first: of a dependent set the first are kept.
///
/// Joint offsets come first (a controller corrects them most easily), then lengths, offsets and
/// twists, then Hayati's angles, then transmission terms that are not constant, then constant
/// transmission offsets (which only an external encoder tells from joint offsets), and last the base
/// row's twist, angle and offset, which place the measuring frame.
pub fn preference_order(parameters: &[ParameterId]) -> Vec<usize> {
    let class = |parameter: &ParameterId| match *parameter {
        ParameterId::Link {
            row: 0,
            parameter: LinkParameter::A,
        } => 1,
        ParameterId::Link { row: 0, parameter } => match parameter {
            LinkParameter::Alpha => 7,
            LinkParameter::Theta => 8,
            _ => 9,
        },
        ParameterId::Link { parameter, .. } => match parameter {
            LinkParameter::Theta => 0,
            LinkParameter::A => 1,
            LinkParameter::D => 2,
            LinkParameter::Alpha => 3,
            LinkParameter::Beta => 4,
        },
        ParameterId::Transmission { index: 0, .. } => 6,
        ParameterId::Transmission { .. } => 5,
    };
    let mut order: Vec<usize> = (0..parameters.len()).collect();
    order.sort_by_key(|&position| (class(&parameters[position]), position));
    order
}

/// Names, units and plausible sizes for the identifiability analysis.
pub fn parameter_infos(device: &Device, parameters: &[ParameterId]) -> Vec<ParameterInfo> {
    parameters
        .iter()
        .map(|parameter| {
            ParameterInfo::new(
                parameter.name(device),
                parameter.unit(device),
                parameter.plausible_size(device),
            )
        })
        .collect()
}
