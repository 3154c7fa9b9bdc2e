//! Refusals of plans.

use std::path::Path;

use haptical_calibration::CalibrationError;
use haptical_design::DesignError;
use haptical_identification::IdentificationError;

use super::{Error, ErrorKind};

impl Error {
    /// A refused plan, said of the argument or file that it came from.
    pub fn design(error: &DesignError, device: &Path) -> Self {
        let text = error.to_string();
        let (what, next) = text
            .split_once("; ")
            .or_else(|| text.split_once(": "))
            .unwrap_or((
                text.as_str(),
                "correct it; the kinds of measurement are in `haptical plan --help`",
            ));
        match error {
            DesignError::NothingIdentifiable { rig, reason } => {
                let (what, reason) = (format!("rig `{rig}`"), reason.clone());
                let error = CalibrationError::NothingIdentifiable { what, reason };
                Self::calibration(&error, device, device)
            }
            DesignError::NoLimits { .. } | DesignError::Pose { .. } => {
                Self::bad_input("device", what, device.display().to_string(), next)
            }
            DesignError::Calibration(error) => Self::calibration(error, device, device),
            DesignError::Identification(error) => {
                let next = "give another rig, or correct the device file";
                let refused =
                    Self::bad_input("analysis", text.clone(), device.display().to_string(), next);
                match error {
                    IdentificationError::NothingFree => refused.of_kind(ErrorKind::Unidentifiable),
                    _ => refused,
                }
            }
            DesignError::Measure { item, message } => {
                let (message, next) = message
                    .rsplit_once("; ")
                    .or_else(|| message.rsplit_once(": "))
                    .unwrap_or((message, "the kinds are in `haptical plan --help`"));
                Self::command_line("measure", format!("measurement `{item}`: {message}"), next)
            }
            _ => Self::command_line("arguments", what, next),
        }
    }
}
