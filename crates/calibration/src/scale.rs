//! The size of a device that no measurement tells: one length is held then.

use haptical_model::{Device, JointType, LinkParameter, ParameterId};

use crate::Channel;

/// Shortest length that holds the others' scale \[m\].
const SHORT_M: f64 = 0.01;

/// Sine of the angle below which two axes count as parallel.
const PARALLEL_SINE: f64 = 0.1;

/// The length that a fit of these channels must hold; none where something measured has a length of its own.
///
/// Touches of unknown points and planes are as true of a device of any size, the points moved with it: all
/// lengths and places times one factor fit as well. They would fit even better, as every residual shrinks with
/// the device, so the direction cannot be left to the data. Held is the longest length, whose relative error is
/// the smallest: across a joint axis, or along one that stands across both of its neighbours. (Along the first
/// axis, or along parallel ones, a length only moves the points, or is told from another one.) Where there is
/// none, it is the longest along any.
pub(crate) fn held_length(device: &Device, channels: &[Channel]) -> Option<ParameterId> {
    let is_metric = |channel: &Channel| match channel {
        Channel::Cable { index } => device
            .cables
            .get(*index)
            .is_none_or(|cable| !cable.fit.scale),
        Channel::Position | Channel::ContactPair { .. } => true,
        _ => false,
    };
    let touches = |channel: &Channel| matches!(channel, Channel::Contact | Channel::Plane);
    let slides = device
        .joints
        .iter()
        .any(|joint| joint.joint_type == JointType::Prismatic);
    if slides || channels.iter().any(is_metric) || !channels.iter().any(touches) {
        return None;
    }
    let lengths = |wanted: &[LinkParameter]| {
        let rows = 1..device.links.len();
        let all = rows.flat_map(|row| wanted.iter().map(move |&parameter| (row, parameter)));
        let sized = all.map(|(row, parameter)| (length_m(device, row, parameter), row, parameter));
        sized.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let along = lengths(&[LinkParameter::D]);
    let across = lengths(&[LinkParameter::A, LinkParameter::B]);
    let between = (2..device.links.len())
        .filter(|&row| stands_across(device, row))
        .map(|row| {
            (
                length_m(device, row, LinkParameter::D),
                row,
                LinkParameter::D,
            )
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let longest = across
        .into_iter()
        .chain(between)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let chosen = longest.filter(|(length, _, _)| *length > SHORT_M).or(along);
    chosen.map(|(_, row, parameter)| ParameterId::Link { row, parameter })
}

/// Whether the axis that a row's offset lies along is parallel to neither of its neighbours; the rows of URDFs,
/// whose axes their origins turn, are left out.
fn stands_across(device: &Device, row: usize) -> bool {
    let turned = |row: usize| match device.links.get(row) {
        Some(link) => link.alpha_rad.sin().abs() > PARALLEL_SINE,
        None => true,
    };
    let is_general = device.is_general_row(row) || device.is_general_row(row - 1);
    !is_general && turned(row - 1) && turned(row)
}

/// Size of what a length moves: its own, and that of the constant origin behind its row, which it corrects.
fn length_m(device: &Device, row: usize, parameter: LinkParameter) -> f64 {
    if parameter == LinkParameter::B && !device.is_general_row(row) {
        return 0.0;
    }
    let axis = match parameter {
        LinkParameter::A => 0,
        LinkParameter::B => 1,
        _ => 2,
    };
    let behind = device.origins.get(row + 1).copied().flatten();
    let behind_m = behind.map_or(0.0, |origin| origin.position_m[axis]);
    (device.links[row].get(parameter.kinematic()) + behind_m).abs()
}

/// The parameters without the one that is held.
pub(crate) fn without_held(
    device: &Device,
    channels: &[Channel],
    mut parameters: Vec<ParameterId>,
) -> Vec<ParameterId> {
    if let Some(held) = held_length(device, channels) {
        parameters.retain(|parameter| *parameter != held);
    }
    parameters
}
