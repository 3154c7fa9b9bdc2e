//! Refusals of device files, and of other TOML files.

use std::io::ErrorKind as ErrorCause;
use std::path::Path;

use haptical_model::DeviceFileError;

use super::{Error, ErrorKind, Place};

impl Error {
    /// A refused device file.
    pub fn device_file(error: &DeviceFileError, path: &Path) -> Self {
        let mut place = Place::in_file(path.display().to_string());
        let text = error.to_string();
        let what = text.strip_prefix(&format!("{}: ", place.file));
        let mut what = what.unwrap_or(&text).to_owned();
        if let Some(at) = error.position() {
            place.line = Some(at.line as u64);
            place.column = Some(at.column as u64);
        }
        let (name, next) = match error {
            DeviceFileError::Unreadable { .. } => {
                ("unreadable", "check the path and its permissions")
            }
            DeviceFileError::TooLarge { .. } => {
                ("too-large", "give a device file; a log goes to --log")
            }
            DeviceFileError::NotText { advice, .. } => {
                what = "not a text in UTF-8".to_owned();
                ("not-text", *advice)
            }
            DeviceFileError::Syntax {
                message, advice, ..
            } => {
                what.clone_from(message);
                ("syntax", advice.as_str())
            }
            DeviceFileError::MissingKey {
                place, key, advice, ..
            } => {
                what = format!("{place} has no `{key}`");
                ("missing-key", &*format!("add `{key}`: {advice}"))
            }
            DeviceFileError::Value {
                place,
                key,
                found,
                allowed,
                ..
            } => {
                what = format!("{place}: `{key}` is {found}");
                ("value", &*format!("correct `{key}`: {allowed}"))
            }
            _ => (
                "shape",
                "correct the file; `haptical init` writes a template to compare with",
            ),
        };
        Self {
            kind: match error {
                DeviceFileError::Unreadable { source, .. } => match source.kind() {
                    ErrorCause::NotFound => ErrorKind::NotFound,
                    _ => ErrorKind::Io,
                },
                _ => ErrorKind::BadInput,
            },
            next: next.to_owned(),
            name,
            what,
            place,
        }
    }
}
