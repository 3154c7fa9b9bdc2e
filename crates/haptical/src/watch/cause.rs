//! Which effect: the rows that were kept since a change, handed to the diagnosis.

use std::path::{Path, PathBuf};

use haptical_data::{LogShape, read_log_from};
use haptical_diagnosis::Verdict;
use serde_json::json;

use super::{COMMAND, WatchOptions};
use crate::device::Device;
use crate::diagnose::{Diagnose, diagnose};
use crate::error::Error;
use crate::files::{NewFile, Record, ResultKind, VERSION, WriteRule, sealed_json, write_result};
use crate::log::Log;

/// Name of the rows that a cause was sought in, and of what says who wrote them.
const ROWS: [&str; 2] = ["alarm.csv", "alarm.csv.provenance.json"];

/// Least motion that a cause is sought in \[s\]: at 1 kHz 2000 rows are two seconds, in which an arm does not go through its range.
const DIAGNOSED_S: f64 = 10.0;

/// What the diagnosis says of the rows since a change.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct WatchCause {
    /// Rows that were diagnosed.
    pub rows: usize,
    /// The answer in words; where the rows say nothing, why.
    pub answer: String,
    /// Verdict of the diagnosis of these rows alone, as in gap.json; none where there is no diagnosis. The alarm counts whatever it is.
    pub verdict: Option<&'static str>,
    /// Effect, where one is named.
    pub effect: Option<String>,
    /// Files that were written.
    pub written: Vec<PathBuf>,
}

/// Said where the diagnosis of the rows alone finds no gap.
const NO_GAP: &str = "none found. The alarm and the diagnosis differ: residuals are not what they were in the reference, and these rows \
    alone show no gap beyond noise. So what moved is smaller than they show, or the reference does not hold this task, load or \
    temperature. Watch on: more rows show more. Or give a reference with this task";

impl WatchOptions {
    /// Refuses, before any row is read, files of the run that must not be written: the page, and those of an alarm.
    ///
    /// # Errors
    /// As [`WriteRule::check`].
    pub fn check_outputs(&self, page: Option<&Path>) -> Result<(), Error> {
        let within = |name: &str| self.out.as_ref().map(|folder| folder.join(name));
        let [rows, record] = ROWS;
        let mut own: Vec<PathBuf> = [record, rows].into_iter().filter_map(within).collect();
        own.extend(page.map(Path::to_owned));
        let diagnosis = ResultKind::DIAGNOSIS.outputs();
        let diagnosis: Vec<PathBuf> = diagnosis.filter_map(within).collect();
        self.rule.check(&own)?;
        self.of_diagnosis().check(&diagnosis)?;
        own.extend(diagnosis);
        self.rule.check_inputs(&own)
    }

    fn of_diagnosis(&self) -> WriteRule {
        self.rule.of_command(ResultKind::DIAGNOSIS.command)
    }
}

/// Writes the rows, with what says who wrote them.
fn write_rows(
    device: &Device,
    text: String,
    (folder, rule): (&Path, &WriteRule),
) -> Result<Vec<PathBuf>, Error> {
    let [rows, record] = ROWS;
    let mut files: Vec<NewFile<'_>> = vec![(rows, text.into_bytes())];
    let inputs = device.inputs("device");
    let own = Record::new(VERSION, COMMAND, Vec::new(), inputs).with_outputs(&files);
    let json = sealed_json(&json!({ "provenance": own }))?;
    files.push((record, json.into_bytes()));
    let written = rule.write(folder, &files, &|| false)?;
    Ok(written.into_iter().take(1).collect())
}

/// Rows since a change after which its cause is sought.
pub(super) fn rows_for_cause(options: &WatchOptions, rows_per_hour: f64) -> u64 {
    let motion = DIAGNOSED_S * rows_per_hour / 3600.0;
    let kept = 0.5 * options.keep_rows as f64;
    (options.diagnosed_rows as u64).max(motion.min(kept) as u64)
}

/// Diagnoses a log against the device that is watched; with a folder writes the rows and gap.json, gap.html there.
pub(super) fn cause(
    device: &Device,
    (text, rows): (String, usize),
    options: &WatchOptions,
) -> Result<WatchCause, Error> {
    let folder = options.out.as_deref();
    let mut written = Vec::new();
    let log = match folder {
        Some(folder) => {
            written = write_rows(device, text, (folder, &options.rule))?;
            Log::read(folder.join(ROWS[0]), device)
        }
        None => {
            let shape = LogShape::from(&device.model);
            read_log_from(text.as_bytes(), ROWS[0], &shape)
                .map_err(|error| Error::log(error, device))
                .and_then(|read| Log::from_recording(read.recording, ROWS[0], device))
        }
    };
    let request = Diagnose {
        model: Some(device),
        ..Diagnose::default()
    };
    let found = match log.and_then(|log| diagnose(device, &log, &request)) {
        Ok(found) => found,
        // a watch goes on, whatever its rows say of a cause
        Err(error) => {
            return Ok(WatchCause {
                rows,
                answer: format!("the rows since the change name no effect: {}", error.what()),
                verdict: None,
                effect: None,
                written,
            });
        }
    };
    if let Some(folder) = folder {
        let kind = ResultKind::DIAGNOSIS;
        let rule = options.of_diagnosis();
        let files = write_result(folder, &kind, &found.files()?, &rule, &|| false)?;
        written.extend(files.written);
    }
    let effect = found.named().map(|cause| cause.0.effect.clone());
    Ok(WatchCause {
        rows,
        answer: match (found.named(), found.diagnosis.verdict) {
            (Some(cause), _) => cause.to_string(),
            (None, Verdict::NoGap) => NO_GAP.to_owned(),
            (None, _) => found.answer.clone(),
        },
        verdict: Some(found.diagnosis.verdict.name()),
        effect,
        written,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_sought_in_ten_seconds_of_motion() {
        let rows = |rate_hz: f64, keep_rows| {
            let options = WatchOptions {
                keep_rows,
                ..WatchOptions::default()
            };
            rows_for_cause(&options, 3600.0 * rate_hz)
        };
        assert_eq!(rows(10.0, 20_000), 2000);
        assert_eq!(rows(1000.0, 20_000), 10_000);
        // as many as are kept, and not all of them: the first are forgotten
        assert_eq!(rows(1000.0, 5000), 2500);
    }
}
