//! Refusals of plans.

use std::path::Path;

use haptical_calibration::CalibrationError;
use haptical_design::DesignError;
use haptical_identification::IdentificationError;

use super::{Error, ErrorKind};

impl Error {
    /// A refused plan, placed at the argument or file that it came from.
    pub fn design(error: &DesignError, device: &Path) -> Self {
        let text = error.to_string();
        let usual = "correct it; the kinds of measurement are in `haptical plan --help`";
        let split = text.split_once("; ").or_else(|| text.split_once(": "));
        let (what, next) = split.unwrap_or((&text, usual));
        match error {
            DesignError::NothingIdentifiable { rig, reason } => {
                let (what, reason) = (format!("rig `{rig}`"), reason.clone());
                let error = CalibrationError::NothingIdentifiable { what, reason };
                Self::calibration(&error, device, device)
            }
            DesignError::NoLimits { .. } | DesignError::Pose { .. } => {
                Self::in_file("device", what, device, next)
            }
            DesignError::Calibration(error) => Self::calibration(error, device, device),
            DesignError::Identification(error) => {
                let next = "give another rig, or correct the device file";
                let refused = Self::in_file("analysis", text.clone(), device, next);
                match error {
                    IdentificationError::NothingFree => refused.of_kind(ErrorKind::Unidentifiable),
                    _ => refused,
                }
            }
            DesignError::Measure { item, message } => {
                let split = message.rsplit_once("; ");
                let split = split.or_else(|| message.rsplit_once(": "));
                let usual = "the kinds are in `haptical plan --help`";
                let (message, next) = split.unwrap_or((message, usual));
                Self::command_line("measure", format!("measurement `{item}`: {message}"), next)
            }
            _ => Self::command_line("arguments", what, next),
        }
    }
}
