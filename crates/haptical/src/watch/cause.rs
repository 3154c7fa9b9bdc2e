//! Which effect: the rows that were kept since a change, handed to the diagnosis.

use std::path::{Path, PathBuf};

use haptical_data::{LogShape, read_log_from};
use haptical_report::write_atomically;

use crate::device::Device;
use crate::diagnose::{Diagnose, diagnose};
use crate::error::Error;
use crate::files::{Overwrite, ResultKind, make_folder, write_result};
use crate::log::Log;

/// Name of the rows that a cause was sought in.
pub(super) const ROWS: &str = "alarm.csv";

/// What the diagnosis says of the rows since a change.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct WatchCause {
    /// Rows that were diagnosed.
    pub rows: usize,
    /// The answer in words; where the rows say nothing, why.
    pub answer: String,
    /// Effect, where one is named.
    pub effect: Option<String>,
    /// Files that were written.
    pub written: Vec<PathBuf>,
}

/// Diagnoses a log against the device that is watched; with a folder writes the rows and gap.json, gap.html there.
pub(super) fn cause(
    device: &Device,
    (text, rows): (String, usize),
    folder: Option<&Path>,
) -> Result<WatchCause, Error> {
    let shape = LogShape::from(&device.model);
    let mut written = Vec::new();
    let log = match folder {
        Some(folder) => {
            let file = folder.join(ROWS);
            let _folder = make_folder(folder)?;
            write_atomically(&file, text.as_bytes())?;
            written.push(file.clone());
            Log::read(&file, device)
        }
        None => read_log_from(text.as_bytes(), ROWS, &shape)
            .map_err(|error| Error::log(error, &device.model))
            .and_then(|read| Log::from_recording(read.recording, ROWS, device)),
    };
    // a watch goes on, whatever its rows say of a cause
    let nothing = |error: &Error, written: Vec<PathBuf>| WatchCause {
        rows,
        answer: format!("the rows since the change name no effect: {}", error.what()),
        effect: None,
        written,
    };
    let log = match log {
        Ok(log) => log,
        Err(error) => return Ok(nothing(&error, written)),
    };
    let options = Diagnose {
        model: Some(device),
        ..Diagnose::default()
    };
    let found = match diagnose(device, &log, &options) {
        Ok(found) => found,
        Err(error) => return Ok(nothing(&error, written)),
    };
    if let Some(folder) = folder {
        let kind = ResultKind::DIAGNOSIS;
        let files = write_result(folder, &kind, &found.files()?, Overwrite::Any, &|| false)?;
        written.extend(files.written);
    }
    let effect = found.named().map(|cause| cause.0.effect.clone());
    Ok(WatchCause {
        rows,
        answer: match found.named() {
            Some(cause) => cause.to_string(),
            None => found.answer.clone(),
        },
        effect,
        written,
    })
}
