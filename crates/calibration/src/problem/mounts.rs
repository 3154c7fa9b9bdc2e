//! Where the tracker stood and what was on the hand, row by row.

use haptical_model::{Device, Mount, Recording};

use crate::{CalibrationError, Channel};

/// What the rows are about; empty where no channel depends on it.
pub(crate) fn mounts(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Result<Vec<Mount>, CalibrationError> {
    if !channels.iter().any(|channel| channel.is_mounted()) {
        return Ok(Vec::new());
    }
    let mounts = device.mounts(recording);
    mounts.map_err(|unplaced| CalibrationError::UnknownTouch {
        line: recording.line.get(unplaced.row).copied().unwrap_or(0),
        column: unplaced.column.to_owned(),
        id: unplaced.id,
    })
}
