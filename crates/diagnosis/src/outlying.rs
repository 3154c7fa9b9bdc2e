//! Readings that stand alone, of a whole recording.

use haptical_calibration::{Channel, channels};
use haptical_effects::device::attached;
use haptical_model::{Device, Recording};

use crate::DiagnosisError;
use crate::engine::{Base, Prepared};
use crate::thresholds::recording::MOST_ROWS;

/// Readings that stand alone, as a diagnosis leaves them out (docs/diagnosis.md, Outliers), of every row of a recording:
/// channel and row, from 0. `device` is the fitted one, [`Diagnosis::device`](crate::Diagnosis::device).
///
/// # Errors
/// [`DiagnosisError`] for a row at which the device has no value.
pub fn outlying_readings(
    device: &Device,
    recording: &Recording,
) -> Result<Vec<(Channel, usize)>, DiagnosisError> {
    let mut device = device.clone();
    let recording = attached(&mut device, recording)?;
    let channels = channels(&device, &recording)?;
    let base = Base::held(device, channels);
    // a diagnosis takes every so many rows of a long recording: all its rows are so many recordings
    let every = recording.len().div_ceil(MOST_ROWS).max(1);
    let mut found = Vec::new();
    for first in 0..every {
        let rows: Vec<usize> = (first..recording.len()).step_by(every).collect();
        let part = recording.select(&rows);
        let prepared = Prepared::new(&base, &part, &part)?;
        let own = prepared.outlying().into_iter();
        found.extend(own.map(|(channel, row)| (channel, rows[row])));
    }
    found.sort_unstable();
    Ok(found)
}
