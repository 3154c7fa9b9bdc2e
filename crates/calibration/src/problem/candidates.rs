//! Parameters that a calibration may free, and their order of preference.

use haptical_identification::ParameterInfo;
use haptical_model::SurroundingParameter;
use haptical_model::kinematics::Convention;
use haptical_model::{Device, Parameter, ParameterId};

/// Two successive axes within this angle count as parallel, so that Hayati's angle is offered.
/// (Judd & Knasinski and Hayati & Mirmirani 1985 advise it where a twist of a few degrees would
/// move the common normal by more than the arm is long.)
const PARALLEL_RAD: f64 = 0.02;

/// The Denavit-Hartenberg parameters of all rows; Hayati's angle only where a row's twist lies between two parallel
/// axes, the base's z being one (docs/equations.md, Structural count); and what is around the chain
/// ([`Device::further_parameters`]). A general row ([`Device::is_general_row`]) offers all six numbers: near
/// 0 they are independent whichever way the axes are, and what is redundant the analysis drops. What the device
/// holds ([`Device::hold`]) is no candidate.
pub fn candidate_parameters(device: &Device) -> Vec<ParameterId> {
    // a row's twist leads to the next joint's axis, or in the modified convention to its own
    let has_axes = |row: usize| match device.convention {
        Convention::Standard => device.has_rows_behind(row),
        Convention::Modified => row > 0,
    };
    let is_parallel = |row: usize| device.links[row].alpha_rad.sin().abs() < PARALLEL_RAD.sin();
    let has_angle = |row: usize| device.is_general_row(row) || (has_axes(row) && is_parallel(row));
    let links = device.link_parameters(true).into_iter();
    let offered = links.filter(|parameter| match *parameter {
        ParameterId::Link { row, parameter } => {
            !device.is_held(row, parameter) && (parameter != Parameter::Beta || has_angle(row))
        }
        _ => true,
    });
    offered.chain(device.further_parameters()).collect()
}

/// Positions of `parameters` by preference, dearest first: of a dependent set the first are kept.
///
/// Joint offsets come first (a controller corrects them most easily), then lengths, offsets and
/// twists, then Hayati's angles, then transmission terms that are not constant, then constant
/// transmission offsets (which only an external encoder tells from joint offsets), and last the base
/// row's twist, angle and offset, which place the measuring frame. A general base row has nothing but
/// such numbers, its length along x included.
///
/// Before all of these come unknown numbers of the surroundings: where tracker, touched points and
/// planes are. The geometry is judged given them, so that of a rig that moves with the device it is the base
/// row that is dependent. A cable's scale comes last: it acts like all lengths together.
pub fn preference_order(parameters: &[ParameterId]) -> Vec<usize> {
    let general_base = parameters.contains(&ParameterId::Link {
        row: 0,
        parameter: Parameter::B,
    });
    let class = |parameter: &ParameterId| -> i8 {
        match *parameter {
            ParameterId::Link {
                row: 0,
                parameter: Parameter::A,
            } if !general_base => 1,
            ParameterId::Link { row: 0, parameter } => match parameter {
                Parameter::Alpha => 7,
                Parameter::Theta => 8,
                _ => 9,
            },
            ParameterId::Link { parameter, .. } => match parameter {
                Parameter::Theta => 0,
                Parameter::A | Parameter::B => 1,
                Parameter::D => 2,
                Parameter::Alpha => 3,
                Parameter::Beta => 4,
            },
            ParameterId::Transmission { index: 0, .. } => 6,
            ParameterId::Transmission { .. } => 5,
            // as much as a joint's other terms that are not constant
            ParameterId::Compliance { .. } | ParameterId::Effect { .. } => 5,
            ParameterId::Surrounding(SurroundingParameter::CableScale { .. }) => 10,
            ParameterId::Surrounding(_) => -1,
        }
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
