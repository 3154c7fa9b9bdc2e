//! Checks that a recording can serve its rig: pairs, planes, tools, and no log that was written otherwise.

use haptical_model::{Device, Recording};

use crate::CalibrationError;
use crate::checks::{otherwise, stuck, tools};
use crate::start::ids::listed;

/// Fewest touches that make a plane and leave one to check it.
const PLANE_ROWS: usize = 4;

/// Refuses a rig that a recording cannot serve: a pair of which one member is not in the log, a plane of too
/// few touches, a tool or a tracker place of too few rows, a cable at a tool; columns that have one value though the device moves; and a
/// log that was written otherwise.
///
/// # Errors
/// [`CalibrationError::Rig`], [`CalibrationError::Reading`], [`CalibrationError::Stuck`], [`CalibrationError::MistakenLog`].
pub fn check_rig(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let refuse = |what: &str, message: String| {
        Err(CalibrationError::Rig {
            what: what.to_owned(),
            message,
        })
    };
    let pairs = device
        .contact_pairs
        .iter()
        .map(|pair| ("contact_pair", "contact", &pair.a, &pair.b));
    let planes = device.surroundings.plane_pairs.iter();
    let planes = planes.map(|pair| ("plane_pair", "plane", &pair.a, &pair.b));
    for (section, column, a, b) in pairs.chain(planes) {
        let ids = match column {
            "contact" => &recording.contact,
            _ => &recording.plane,
        };
        // a log without the column is one of another rig
        let Some(ids) = ids else {
            continue;
        };
        if a == b {
            let message = format!("it names `{a}` twice: name two of the log's column `{column}`");
            return refuse(&format!("[[{section}]]"), message);
        }
        for id in [a, b] {
            if !ids.contains(id) {
                let known: Vec<String> = listed(ids).iter().map(|id| format!("`{id}`")).collect();
                let message = format!(
                    "it names `{id}`, which the log's column `{column}` does not have (it has {}): correct the \
                     name or remove the pair",
                    known.join(", ")
                );
                return refuse(&format!("[[{section}]]"), message);
            }
        }
    }
    if let Some(ids) = &recording.plane {
        for id in listed(ids) {
            let rows = ids.iter().filter(|other| **other == id).count();
            if rows < PLANE_ROWS {
                let message = format!(
                    "the plane `{id}` is touched in {rows} rows; three lie on a plane whatever the device is: \
                     record at least {PLANE_ROWS}, better 20, or leave these cells empty"
                );
                return refuse("column `plane`", message);
            }
        }
    }
    tools::check(device, recording)?;
    stuck::check(device, recording)?;
    otherwise::check(device, recording)
}
