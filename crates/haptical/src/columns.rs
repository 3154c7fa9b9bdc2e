//! The columns of a log that hold the readings of channels.

use haptical_calibration::Channel;
use haptical_data::LogColumn;
use haptical_model::Recording;

/// Those of a channel, axis by axis, of an orientation part by part; none of pairs and fixtures.
pub(crate) fn columns_of(channel: Channel) -> Vec<LogColumn> {
    match channel {
        Channel::Output { joint } => vec![LogColumn::Output(joint)],
        Channel::Cable { index } => vec![LogColumn::Cable(index)],
        Channel::Position => (0..3).map(LogColumn::Position).collect(),
        Channel::Orientation => (0..4).map(LogColumn::Orientation).collect(),
        Channel::Contact => vec![LogColumn::Contact],
        Channel::Plane => vec![LogColumn::Plane],
        _ => Vec::new(),
    }
}

/// All numbers that a recording has besides its joints.
pub(crate) fn measured_columns(recording: &Recording) -> Vec<LogColumn> {
    let outputs = (0..recording.output.len()).map(LogColumn::Output);
    let cables = (0..recording.cable_m.len()).map(LogColumn::Cable);
    outputs.chain(cables).chain(tracked_columns()).collect()
}

/// Position and orientation that a tracker reads.
pub(crate) fn tracked_columns() -> impl Iterator<Item = LogColumn> {
    let tracked = [Channel::Position, Channel::Orientation];
    tracked.into_iter().flat_map(columns_of)
}
