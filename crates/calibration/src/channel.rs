//! The measured channels of a recording that a device can predict.

use haptical_model::{Device, Recording};

use crate::CalibrationError;

/// A measured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// External encoder of a joint (from 0).
    Output {
        /// Joint, from 0.
        joint: usize,
    },
    /// Distance of a cable encoder (from 0).
    Cable {
        /// Cable, from 0.
        index: usize,
    },
    /// Handle position, three residuals a row.
    Position,
    /// Handle orientation, three residuals a row.
    Orientation,
}

impl Channel {
    /// Column name without its unit: `out2`, `cable`, `cable2`, `position`, `orientation`.
    pub fn name(self) -> String {
        match self {
            Self::Output { joint } => format!("out{}", joint + 1),
            Self::Cable { index: 0 } => "cable".to_owned(),
            Self::Cable { index } => format!("cable{}", index + 1),
            Self::Position => "position".to_owned(),
            Self::Orientation => "orientation".to_owned(),
        }
    }

    /// Unit of its residuals.
    pub fn unit(self, device: &Device) -> &'static str {
        match self {
            Self::Output { joint } => device.joints[joint].unit(),
            Self::Cable { .. } | Self::Position => "m",
            Self::Orientation => "rad",
        }
    }

    /// Residuals that one row gives.
    pub fn width(self) -> usize {
        match self {
            Self::Output { .. } | Self::Cable { .. } => 1,
            Self::Position | Self::Orientation => 3,
        }
    }

    /// Whether it sees the chain (all but the external encoders do).
    pub fn sees_chain(self) -> bool {
        !matches!(self, Self::Output { .. })
    }

    /// Whether a row of the recording has a reading of this channel.
    pub fn has_reading(self, recording: &Recording, row: usize) -> bool {
        let finite =
            |column: Option<&Vec<f64>>| column.is_some_and(|column| column[row].is_finite());
        match self {
            Self::Output { joint } => finite(recording.output.get(joint).and_then(Option::as_ref)),
            Self::Cable { index } => finite(recording.cable_m.get(index).and_then(Option::as_ref)),
            Self::Position => recording
                .position_m
                .as_ref()
                .is_some_and(|axes| axes.iter().all(|axis| axis[row].is_finite())),
            Self::Orientation => recording
                .orientation_wxyz
                .as_ref()
                .is_some_and(|parts| parts.iter().all(|part| part[row].is_finite())),
        }
    }
}

/// The channels that a recording has readings of and the device can predict, outputs first.
///
/// # Errors
/// [`CalibrationError::NoChannel`], or [`CalibrationError::UnknownTracker`].
pub fn channels(device: &Device, recording: &Recording) -> Result<Vec<Channel>, CalibrationError> {
    let mut found: Vec<Channel> = (0..device.joints.len())
        .map(|joint| Channel::Output { joint })
        .collect();
    if device.has_links() {
        found.extend((0..recording.cable_m.len()).map(|index| Channel::Cable { index }));
        if recording.position_m.is_some() || recording.orientation_wxyz.is_some() {
            check_tracker(device)?;
            found.extend([Channel::Position, Channel::Orientation]);
        }
    }
    found.retain(|channel| (0..recording.len()).any(|row| channel.has_reading(recording, row)));
    if found.is_empty() {
        Err(CalibrationError::NoChannel)
    } else {
        Ok(found)
    }
}

fn check_tracker(device: &Device) -> Result<(), CalibrationError> {
    match &device.tracker {
        Some(tracker) if !tracker.base_known => {
            Err(CalibrationError::UnknownTracker { which: "base" })
        }
        Some(tracker) if !tracker.tool_known => {
            Err(CalibrationError::UnknownTracker { which: "tool" })
        }
        _ => Ok(()),
    }
}
