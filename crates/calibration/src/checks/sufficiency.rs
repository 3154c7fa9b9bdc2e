//! Looks at a recording before anything is fitted: does anything move, can the readings be true?

use haptical_model::{Device, Recording};

use crate::{CalibrationError, Channel};

/// A joint moves if its readings spread by more than this \[rad or m\]: far below any useful
/// motion, above the jitter of an encoder that rests between two counts.
const MOTION: f64 = 5e-3;

/// Smallest and largest reading.
pub(crate) fn extremes(readings: &[f64]) -> [f64; 2] {
    let low = readings.iter().copied().fold(f64::INFINITY, f64::min);
    let high = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}

/// Joints (from 0) whose readings stay at one place.
pub(crate) fn resting_joints(recording: &Recording) -> Vec<usize> {
    recording
        .joint
        .iter()
        .enumerate()
        .filter(|(_, column)| {
            let [low, high] = extremes(column);
            high - low < MOTION
        })
        .map(|(joint, _)| joint)
        .collect()
}

/// Refuses recordings without motion and distances that no cable can have.
///
/// # Errors
/// [`CalibrationError::NoMotion`] where no joint moves by 5 mrad (or mm), [`CalibrationError::Reading`]
/// naming line and column of a distance that no cable can have.
pub fn check(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Result<(), CalibrationError> {
    if resting_joints(recording).len() == device.joints.len() {
        return Err(CalibrationError::NoMotion {
            rows: recording.len(),
        });
    }
    for channel in channels {
        let Channel::Cable { index } = *channel else {
            continue;
        };
        let Some(column) = recording.cable_m.get(index).and_then(Option::as_ref) else {
            continue;
        };
        if let Some(row) = column
            .iter()
            .position(|distance| *distance < SHORTEST_CABLE_M)
        {
            return Err(CalibrationError::Reading {
                line: recording.line[row],
                column: format!("{}_m", channel.name()),
                message: format!(
                    "distance {} m: the handle is on top of the cable exit, where the distance has \
                     no derivative; leave such rows out",
                    column[row]
                ),
            });
        }
    }
    Ok(())
}

/// Shorter distances have no usable direction \[m\].
const SHORTEST_CABLE_M: f64 = 1e-6;
