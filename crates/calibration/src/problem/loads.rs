//! The drive torques at each row, to which compliant joints yield.

use haptical_model::{Device, Recording};

use crate::CalibrationError;
use crate::error::at_row;

/// Rows that one thread works out at a time.
const ROWS_AT_ONCE: usize = 64;

/// [`haptical_model::holding_torques_nm`], some rows at a time in parallel, each as it is alone.
fn held_torques_nm(
    device: &Device,
    recording: &Recording,
) -> Result<Option<Vec<Vec<f64>>>, CalibrationError> {
    let bare = Recording {
        line: vec![0; recording.len()],
        joint: recording.joint.clone(),
        force_n: recording.force_n.clone(),
        hand: recording.hand.clone(),
        ..Recording::default()
    };
    let rows: Vec<usize> = (0..recording.len()).collect();
    let parts = haptical_parallel::map(rows.chunks(ROWS_AT_ONCE), |part| {
        haptical_model::holding_torques_nm(device, &bare.select(part))
    });
    let mut columns: Option<Vec<Vec<f64>>> = None;
    for part in parts {
        let part = part.map_err(|source| at_row(recording, 0)(source.into()))?;
        let Some(part) = part else {
            return Ok(None);
        };
        let whole = columns.get_or_insert_with(|| vec![Vec::new(); part.len()]);
        for (column, part) in whole.iter_mut().zip(part) {
            column.extend(part);
        }
    }
    Ok(columns)
}

/// Torques, row by row, joint by joint.
#[derive(Debug)]
pub(crate) struct Loads {
    joints: usize,
    torque_nm: Vec<f64>,
}

impl Loads {
    /// None where no joint of the device yields. Torques are those of the log where it has them, else those
    /// that hold the device's masses and the hand at rest; what is not known is 0. They do not change in a
    /// search: a millimetre of geometry moves them by a thousandth, and what the joints yield by hundredths, for
    /// which a fit is repeated.
    ///
    /// # Errors
    /// [`CalibrationError::Row`] where the chain has no pose.
    pub(crate) fn new(
        device: &Device,
        recording: &Recording,
    ) -> Result<Option<Self>, CalibrationError> {
        if device.has_compliance() {
            let joints = device.joints.len();
            let held = held_torques_nm(device, recording)?;
            let mut torque_nm = Vec::with_capacity(joints * recording.len());
            for row in 0..recording.len() {
                for joint in 0..joints {
                    let logged = recording.torque_nm.get(joint).and_then(Option::as_ref);
                    let logged = logged
                        .map(|column| column[row])
                        .filter(|torque| torque.is_finite());
                    let held = || held.as_ref().map(|columns| columns[joint][row]);
                    torque_nm.push(logged.or_else(held).unwrap_or(0.0));
                }
            }
            return Ok(Some(Self { joints, torque_nm }));
        }
        Ok(None)
    }

    /// Whether there is no torque at all: no column, and no masses that gravity pulls at.
    pub(crate) fn are_none(&self) -> bool {
        self.torque_nm.iter().all(|torque| *torque == 0.0)
    }

    /// Torques of one row, joint by joint.
    pub(crate) fn of_row(&self, row: usize) -> &[f64] {
        &self.torque_nm[row * self.joints..][..self.joints]
    }
}
