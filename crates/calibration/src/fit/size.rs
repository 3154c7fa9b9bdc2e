//! The size of a device that no measurement fixes: one length is held then.

use haptical_identification::{
    Identifiability, IdentifiabilityRules, Matrix, Reduction, Status, Term, evaluate_jacobian,
};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, Parameter, ParameterId, Recording, SurroundingParameter};

use crate::fit::free_set::judge;
use crate::problem::form::Prepared;
use crate::problem::gauge::{are_touches_without_length, is_pair};
use crate::start::points;
use crate::{Channel, DeviceProblem, ParameterFit, Weights, candidate_parameters, parameter_infos};

/// Shortest length that holds the others' scale \[m\].
const SHORT_M: f64 = 0.01;
/// Postures of which the two farthest apart make a gauge of the device's size.
const POSTURES: usize = 8;
/// Share of its length to which that gauge counts as known.
const GAUGE_SHARE: f64 = 1e-3;
/// Share of its size below which a device has been drawn to a point: none is known so badly.
const LEAST_SHARE: f64 = 0.25;
/// Share of the held length's plausible error below which another parameter's error does not act like it.
const NEGLIGIBLE: f64 = 1e-3;

/// The parameters that a fit of these channels must hold; none where something measured has a length of its own.
///
/// Touches of unknown points and planes are as true of a device of any size, the points moved with it: all
/// lengths and places times one factor fit as well. They would fit even better, as every residual shrinks with
/// the device, so the direction cannot be left to the data. Held is the parameter that stands for the longest
/// length, whose relative error is the smallest. Not the longest number: an upper arm may be two offsets along one
/// axis, of which one is fitted and stands for both, and a short number that is held lets all others shrink around
/// it. A dependent parameter's length therefore counts with those that it acts like, and those that act like the
/// held one are held with it: each would take its place.
/// Source: docs/equations.md, Touched points.
///
/// `device` is prepared for the recording. None too where it has no value at a row: the fit then refuses with the reason.
pub fn held_for_scale(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Vec<ParameterId> {
    let judged = is_open(device, channels).then(|| judged(device, recording, channels));
    let Some((parameters, judged)) = judged.flatten() else {
        return Vec::new();
    };
    let mut lengths: Vec<f64> = parameters
        .iter()
        .map(|&parameter| length(device, parameter))
        .collect();
    for (index, status) in judged.statuses.iter().enumerate() {
        for term in combination(status) {
            lengths[term.parameter] += lengths[index] * term.coefficient;
        }
    }
    let may_be_held = |index: &usize| {
        matches!(parameters[*index], ParameterId::Link { row, .. } if row > 0)
            && parameters[*index].unit(device) == "m"
            && matches!(judged.statuses[*index], Status::Identifiable { .. })
            && lengths[*index].abs() > SHORT_M
    };
    let longest = (0..parameters.len())
        .filter(may_be_held)
        .max_by(|a, b| lengths[*a].abs().total_cmp(&lengths[*b].abs()));
    let Some(longest) = longest else {
        return Vec::new();
    };
    let size = |index: usize| parameters[index].plausible_size(device);
    let acts_like_it = |index: &usize| {
        let terms = combination(&judged.statuses[*index]).iter();
        let mut own = terms.filter(|term| term.parameter == longest);
        own.any(|term| term.coefficient.abs() * size(*index) > NEGLIGIBLE * size(longest))
    };
    let is_held = |index: &usize| *index == longest || acts_like_it(index);
    let held = (0..parameters.len()).filter(is_held);
    held.map(|index| parameters[index]).collect()
}

/// The parameters that a fit of the chain held for its scale: candidates that it was not asked for.
pub(crate) fn held_for_size(fit: &ParameterFit, prepared: &Device) -> Vec<ParameterId> {
    let candidates = candidate_parameters(prepared).into_iter();
    candidates
        .filter(|parameter| !fit.parameters.contains(parameter))
        .collect()
}

/// What a dependent parameter acts like.
fn combination(status: &Status) -> &[Term] {
    match status {
        Status::Dependent { combination } => combination,
        _ => &[],
    }
}

/// The candidates, judged at the device with a gauge of its size: near data that agree, the size would be a
/// dependent direction itself.
fn judged(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Option<(Vec<ParameterId>, Identifiability)> {
    let parameters = candidate_parameters(device);
    let weights = Weights::stated(device, channels);
    let problem = DeviceProblem::new(device, recording, channels, &parameters, &weights).ok()?;
    let prepared = Prepared::new(&problem).ok()?;
    let searched = prepared.searched();
    let all: Vec<usize> = (0..parameters.len()).collect();
    let (jacobian, _) = evaluate_jacobian(searched, &problem.start(), &all).ok()?;
    let gauge = gauge(device, recording, &parameters);
    let rows = jacobian.rows();
    let with_gauge = Matrix::from_fn(rows + 1, all.len(), |row, column| {
        if row < rows {
            jacobian[(row, column)]
        } else {
            gauge[column]
        }
    });
    let infos = parameter_infos(device, &parameters);
    let reduction = Reduction::new(&with_gauge, &vec![0.0; rows + 1]).ok()?;
    let rules = IdentifiabilityRules::default();
    let judged = judge(&problem, &infos, &reduction, &[], &rules).ok()?;
    Some((parameters, judged))
}

/// Whether touches are all that could fix lengths, and no length is stated as exact.
pub(crate) fn is_open(device: &Device, channels: &[Channel]) -> bool {
    let is_kept = |((row, number), size): (&(usize, Parameter), &f64)| {
        let kept = ParameterId::Link {
            row: *row,
            parameter: *number,
        };
        *size == 0.0 && *row > 0 && length(device, kept).abs() > SHORT_M
    };
    let is_stated = device.deviations.iter().any(is_kept);
    are_touches_without_length(device, channels) && !channels.iter().any(is_pair) && !is_stated
}

/// Change of a parameter with the device's size, per share: a length's own, with that of the constant origin
/// behind its row, which it corrects.
fn length(device: &Device, parameter: ParameterId) -> f64 {
    let value = parameter.value(device);
    match parameter {
        ParameterId::Link { row, parameter } => {
            let axis = match parameter {
                Parameter::A => 0,
                Parameter::B => 1,
                Parameter::D => 2,
                _ => return 0.0,
            };
            let behind = device.origins.get(row + 1).copied().flatten();
            value + behind.map_or(0.0, |origin| origin.position_m[axis])
        }
        ParameterId::Surrounding(SurroundingParameter::CableScale { .. }) => value,
        _ if parameter.unit(device) == "m" => value,
        _ => 0.0,
    }
}

/// Derivatives of the distance between the handle's places at two postures, as a residual known to a share of it;
/// zeros where there is none.
fn gauge(device: &Device, recording: &Recording, parameters: &[ParameterId]) -> Vec<f64> {
    let mut seen: Vec<(Vector3<f64>, Vec<Vector3<f64>>)> = Vec::new();
    at_sample(device, recording, |evaluation, position_m| {
        let moves = parameters.iter();
        let moves = moves.map(|&parameter| evaluation.pose_derivative(parameter).linear);
        seen.push((position_m, moves.collect()));
    });
    let mut farthest = (0.0, vec![0.0; parameters.len()]);
    for (index, (from, from_moves)) in seen.iter().enumerate() {
        for (to, to_moves) in &seen[..index] {
            let way = to - from;
            let distance = way.norm();
            if distance > farthest.0 {
                let direction = way / (distance * distance * GAUGE_SHARE);
                let moves = to_moves.iter().zip(from_moves);
                let row = moves.map(|(to, from)| direction.dot(&(to - from)));
                farthest = (distance, row.collect());
            }
        }
    }
    farthest.1
}

/// The handle's places at postures of which each joint has a reading of the log, each of another row: no postures
/// of the log, where touches may all be at one point.
fn at_sample(
    device: &Device,
    recording: &Recording,
    mut look: impl FnMut(&Evaluation<'_>, Vector3<f64>),
) {
    let rows = recording.len();
    let mut evaluation = Evaluation::new(device);
    for posture in 0..POSTURES.min(rows) {
        let columns = recording.joint.iter().enumerate();
        let step = |joint: usize| posture * (rows / POSTURES + 1 + joint);
        let readings: Vec<f64> = columns
            .map(|(joint, column)| column[step(joint) % rows])
            .collect();
        evaluation.choose_hand(device.hand_at(recording, posture));
        let moved = evaluation.move_to(&readings);
        let pose = moved.and_then(|()| evaluation.pose().map(|pose| pose.position_m));
        if let Ok(position_m) = pose {
            look(&evaluation, position_m);
        }
    }
}

/// Root mean square distance of the handle's places from their middle, of the sample of postures.
pub(crate) fn spread_m(device: &Device, recording: &Recording) -> f64 {
    let mut places = Vec::with_capacity(POSTURES);
    at_sample(device, recording, |_, position_m| places.push(position_m));
    points::spread_m(&places)
}

/// The share of its former size that a fitted device has, where touches alone were measured and they drew it to
/// a point: there all touches agree, whatever the device is.
pub(crate) fn collapsed(
    before: &Device,
    after: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Option<f64> {
    if !is_open(before, channels) {
        return None;
    }
    let share = spread_m(after, recording) / spread_m(before, recording);
    (share < LEAST_SHARE).then_some(share)
}
