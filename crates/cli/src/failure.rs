//! What went wrong, as three lines for people (what, where, next step) or as JSON for programs.

mod device_file;
mod equipment;
mod log;
mod place;
mod urdf_file;

use std::path::Path;
use std::process::ExitCode;

use haptical_calibration::CalibrationError;
use haptical_diagnosis::DiagnosisError;
use haptical_report::ReportError;
use serde_json::json;

use self::place::Place;
use crate::interrupt::STATUS_INTERRUPTED;
use crate::{STATUS_BAD_INPUT, terminal};

/// Exit status where the numbers are sound but fix nothing.
const STATUS_UNIDENTIFIABLE: u8 = 3;

/// A refusal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Failure {
    /// Name of the kind, for programs.
    kind: &'static str,
    what: String,
    place: Box<Place>,
    next: String,
    status: u8,
}

impl Failure {
    /// Bad input at a place given in words or as a path.
    pub(crate) fn bad_input(
        kind: &'static str,
        what: impl Into<String>,
        place: impl Into<String>,
        next: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            what: what.into(),
            place: Place::in_file(place),
            next: next.into(),
            status: STATUS_BAD_INPUT,
        }
    }

    /// Bad input in a line of a log.
    pub(crate) fn log_line(
        kind: &'static str,
        what: impl Into<String>,
        log: &Path,
        line: Option<u64>,
        next: impl Into<String>,
    ) -> Self {
        let mut failure = Self::bad_input(kind, what, log.display().to_string(), next);
        failure.place.line = line;
        failure
    }

    /// Bad input at a line and a column of a file; column 0 is none.
    pub(crate) fn placed(
        kind: &'static str,
        what: impl Into<String>,
        file: &Path,
        (line, column): (u64, u64),
        next: impl Into<String>,
    ) -> Self {
        let mut failure = Self::log_line(kind, what, file, Some(line), next);
        failure.place.column = (column > 0).then_some(column);
        failure
    }

    /// What is wrong.
    pub(crate) fn what(&self) -> &str {
        &self.what
    }

    /// Bad arguments.
    pub(crate) fn command_line(
        kind: &'static str,
        what: impl Into<String>,
        next: impl Into<String>,
    ) -> Self {
        Self::bad_input(kind, what, "the command line", next)
    }

    /// Ctrl-C while `out` was written.
    pub(crate) fn interrupted(out: &Path) -> Self {
        let place = out.display().to_string();
        Self {
            status: STATUS_INTERRUPTED,
            ..Self::bad_input(
                "interrupted",
                "interrupted before the end; nothing was written",
                place,
                "run the command again",
            )
        }
    }

    /// A failure of the program itself; no input should lead here.
    pub(crate) fn internal(what: impl std::fmt::Display) -> Self {
        let next = "please report it with the device file and the log";
        Self::bad_input("internal", what.to_string(), "haptical itself", next)
    }

    /// A refused calibration of a device from a log.
    pub(crate) fn calibration(error: &CalibrationError, device: &Path, log: &Path) -> Self {
        let (kind, what, next) = describe(error);
        let mut place = Place::in_file(log.display().to_string());
        match error {
            CalibrationError::Row { line, .. } => place.line = Some(*line),
            CalibrationError::LooksLikeMillimetres { line, .. } => place.line = *line,
            CalibrationError::Reading { line, column, .. } => {
                place.line = Some(*line);
                place.column_name = Some(column.clone());
            }
            CalibrationError::Rig { what, .. } if what.starts_with('[') => {
                place.file = device.display().to_string();
                place.section = Some(what.trim_matches(['[', ']']).to_owned());
            }
            CalibrationError::Option { .. } => "the command line".clone_into(&mut place.file),
            _ => {}
        }
        let status = if error.is_unidentifiable() {
            STATUS_UNIDENTIFIABLE
        } else {
            STATUS_BAD_INPUT
        };
        Self {
            kind,
            what,
            place,
            next,
            status,
        }
    }

    /// A refused diagnosis of a device from a log.
    pub(crate) fn diagnosis(error: &DiagnosisError, device: &Path, log: &Path) -> Self {
        if let DiagnosisError::Calibration(error) = error {
            return Self::calibration(error, device, log);
        }
        let log_place = log.display().to_string();
        let text = error.to_string();
        match error {
            DiagnosisError::Row { line, source } => {
                let next = "leave this row out of the log, or correct the device file";
                Self::log_line("row", source.to_string(), log, Some(*line), next)
            }
            DiagnosisError::UnknownEffect { .. } => {
                let (what, next) = split_advice(&text);
                Self::command_line("unknown-effect", what, next)
            }
            DiagnosisError::TooFewReadings { .. } => {
                let (what, next) = text.split_once(": ").unwrap_or((&text, "record more rows"));
                Self {
                    status: STATUS_UNIDENTIFIABLE,
                    ..Self::bad_input("too-few-rows", what, log_place, next)
                }
            }
            DiagnosisError::Identification(_) => Self::bad_input(
                "identification",
                text,
                log_place,
                "check the device's lengths and home, and leave out the rows that are named",
            ),
            other if other.is_unidentifiable() => Self {
                status: STATUS_UNIDENTIFIABLE,
                ..Self::bad_input(
                    "nothing-identifiable",
                    text,
                    log_place,
                    "record slow motion of every joint through its whole range",
                )
            },
            _ => Self::internal(text),
        }
    }

    /// Whether it says what, where and what to do next.
    #[cfg(test)]
    pub(crate) fn has_all_parts(&self) -> bool {
        let parts = [&self.what, &self.place.file, &self.next];
        parts.iter().all(|part| !part.trim().is_empty())
    }

    /// Says it, and gives the exit status.
    pub(crate) fn report(&self, as_json: bool) -> ExitCode {
        if as_json {
            let object = json!({"error": {
                "kind": self.kind,
                "what": self.what,
                "where": self.place.to_string(),
                "file": self.place.file,
                "line": self.place.line,
                "column": self.place.column,
                "column_name": self.place.column_name,
                "next": self.next,
            }});
            // Where standard output fails too, the text below still says what happened.
            let _ = terminal::write_output(format!("{object:#}\n").as_bytes());
        }
        terminal::write_message(&format!(
            "error: {}\n  where: {}\n  next: {}\n",
            one_line(&self.what),
            one_line(&self.place.to_string()),
            one_line(&self.next)
        ));
        ExitCode::from(self.status)
    }
}

/// Kind, what and next step of a refused calibration.
fn describe(error: &CalibrationError) -> (&'static str, String, String) {
    let more = "record at many different poses that move every joint".to_owned();
    match error {
        CalibrationError::NoMotion { rows } => (
            "no-motion",
            format!(
                "no joint moves in the log ({rows} rows at one pose), so nothing can be told apart"
            ),
            more,
        ),
        CalibrationError::TooFewRows {
            what,
            rows,
            parameters,
            advised,
        } => (
            "too-few-rows",
            format!("{what}: {rows} readings cannot fix {parameters} parameters"),
            format!("record at least {advised} readings at different poses"),
        ),
        CalibrationError::NothingIdentifiable { .. } => {
            ("nothing-identifiable", error.to_string(), more)
        }
        CalibrationError::NotConverged { what, reason } => (
            "not-converged",
            format!("{what}: {reason}"),
            "the nominal device may be far from the real one: check its lengths, twists, home and \
             ratios against the device; with --loss squares, wild readings alone can do this: leave it at auto"
                .to_owned(),
        ),
        CalibrationError::Identification { .. } => (
            "identification",
            error.to_string(),
            "check the device's lengths and home, and leave out the rows that are named".to_owned(),
        ),
        CalibrationError::Row { source, .. } => (
            "row",
            source.to_string(),
            "leave this row out of the log, or correct the device file".to_owned(),
        ),
        CalibrationError::Reading { message, .. } => {
            let (what, next) = split_advice(message);
            ("reading", what, next)
        }
        CalibrationError::LooksLikeMillimetres { what, next, .. } => {
            ("looks-like-millimetres", what.clone(), (*next).to_owned())
        }
        CalibrationError::MistakenColumns { .. } => {
            let (what, next) = split_advice(&error.to_string());
            ("mistaken-columns", what, next)
        }
        CalibrationError::Rig { what, message } => {
            let (message, next) = message
                .rsplit_once(": ")
                .unwrap_or((message, "correct the rig or the log"));
            ("calibration", format!("{what}: {message}"), next.to_owned())
        }
        CalibrationError::NoChannel => (
            "no-channel",
            "the log has no measurement that this device can be identified from".to_owned(),
            "add external encoders (outN_rad), or [[link]] rows to the device and a distance \
             (cable_m) or position (x_m, y_m, z_m) to the log"
                .to_owned(),
        ),
        other => {
            let (what, next) = split_advice(&other.to_string().replacen(": ", "; ", 1));
            ("calibration", what, next)
        }
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::internal(error)
    }
}

/// A message of the form "what; what to do". A semicolon between backticks belongs to what was
/// found in a file.
fn split_advice(text: &str) -> (String, String) {
    let even = |text: &str| text.matches('`').count().is_multiple_of(2);
    // A backtick in what was found makes the count odd; then the last semicolon is ours.
    let outside = |at: usize| even(&text[..at]) && even(&text[at..]);
    let at = text
        .match_indices("; ")
        .map(|(at, _)| at)
        .find(|&at| outside(at))
        .or_else(|| text.rfind("; "));
    match at {
        Some(at) => (text[..at].to_owned(), text[at + 2..].to_owned()),
        None => (text.to_owned(), "correct the input".to_owned()),
    }
}

/// The three lines stay three, whatever a file name or a cell holds.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_told_from_what_a_cell_holds() {
        let split = |text| {
            let (what, next) = split_advice(text);
            [what, next]
        };
        assert_eq!(
            split("found `1; 2`; correct it"),
            ["found `1; 2`", "correct it"]
        );
        assert_eq!(
            split("found `a`b; c`; correct it"),
            ["found `a`b; c`", "correct it"]
        );
        assert_eq!(split("no advice"), ["no advice", "correct the input"]);
    }

    #[test]
    fn a_refused_diagnosis_has_what_where_next_and_its_status() {
        let refused = |error: DiagnosisError| {
            Failure::diagnosis(&error, Path::new("device.toml"), Path::new("log.csv"))
        };
        let few = refused(DiagnosisError::TooFewReadings {
            readings: 12,
            parameters: 57,
            advised: 1140,
        });
        assert_eq!(
            (few.status, few.place.file.as_str()),
            (STATUS_UNIDENTIFIABLE, "log.csv")
        );
        assert!(few.what.starts_with("12 usable readings") && few.what.ends_with("57 parameters"));
        assert!(
            few.next.starts_with("record at least 1140 rows"),
            "{}",
            few.next
        );
        let name = refused(DiagnosisError::UnknownEffect {
            name: "backlsh".to_owned(),
            nearest: Some("backlash".to_owned()),
        });
        assert_eq!(
            (name.status, name.kind),
            (STATUS_BAD_INPUT, "unknown-effect")
        );
        assert_eq!(name.next, "did you mean `backlash`?");
        let still = refused(CalibrationError::NoMotion { rows: 400 }.into());
        assert_eq!(
            (still.status, still.kind),
            (STATUS_UNIDENTIFIABLE, "no-motion")
        );
    }
}
