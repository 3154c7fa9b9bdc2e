//! The content of gap.json: the diagnosis with what it was made from.

use haptical_diagnosis::Diagnosis;
use serde::Serialize;

use crate::arguments::DiagnoseArguments;
use crate::failure::Failure;

/// gap.json.
#[derive(Debug, Serialize)]
pub(crate) struct GapFile<'a> {
    #[serde(flatten)]
    pub(crate) diagnosis: &'a Diagnosis,
    pub(crate) haptical_version: &'static str,
    pub(crate) device: String,
    pub(crate) log: String,
    /// Second log; none where blocks of the first were held out.
    pub(crate) validate: Option<String>,
    /// Model identified earlier; none where it was identified from the log.
    pub(crate) model: Option<String>,
}

impl<'a> GapFile<'a> {
    /// The diagnosis and the names of its files as they were given.
    pub(crate) fn new(diagnosis: &'a Diagnosis, arguments: &DiagnoseArguments) -> Self {
        Self {
            diagnosis,
            haptical_version: env!("CARGO_PKG_VERSION"),
            device: arguments.device.display().to_string(),
            log: arguments.log.display().to_string(),
            validate: arguments
                .validate
                .as_ref()
                .map(|path| path.display().to_string()),
            model: arguments
                .model
                .as_ref()
                .map(|path| path.display().to_string()),
        }
    }

    /// The text of the file.
    pub(crate) fn to_json(&self) -> Result<String, Failure> {
        let mut json = serde_json::to_string_pretty(self).map_err(Failure::internal)?;
        json.push('\n');
        Ok(json)
    }
}
