//! The one error of the library: what is wrong, where, and what to do next.

mod design;
mod device_file;
mod effect;
mod equipment;
mod log;
mod place;
mod urdf_file;

use std::path::Path;

pub use self::place::Place;
use haptical_calibration::CalibrationError;
use haptical_diagnosis::DiagnosisError;
use haptical_identification::Interrupt;
use haptical_report::ReportError;

use crate::files::reason;

/// What to do where a row or the numbers of a device fit nothing.
const LEAVE_ROW_OUT: &str = "leave this row out of the log, or correct the device file";
const CHECK_DEVICE: &str =
    "check the device's lengths and home, and leave out the rows that are named";

/// Kinds of refusals; the command has an exit status for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Input that is not what it must be.
    BadInput,
    /// A file that is not there.
    NotFound,
    /// A file that the system does not let read or write.
    Io,
    /// Sound numbers that fix nothing.
    Unidentifiable,
    /// Stopped on request before the end; nothing was written.
    Interrupted,
    /// A fault of this library; no input should lead here.
    Internal,
}

/// A refusal: its kind, what is wrong, where, and what to do next.
#[derive(Debug, Clone, PartialEq)]
pub struct Error {
    kind: ErrorKind,
    name: &'static str,
    what: String,
    place: Box<Place>,
    next: String,
}

impl Error {
    /// Bad input at a place given in words or as a path.
    pub fn bad_input(
        name: &'static str,
        what: impl Into<String>,
        place: impl Into<String>,
        next: impl Into<String>,
    ) -> Self {
        Self {
            kind: ErrorKind::BadInput,
            name,
            what: what.into(),
            place: Place::in_file(place),
            next: next.into(),
        }
    }

    /// Bad input in a file.
    pub fn in_file(
        name: &'static str,
        what: impl Into<String>,
        file: &Path,
        next: impl Into<String>,
    ) -> Self {
        Self::bad_input(name, what, file.display().to_string(), next)
    }

    /// The same in one text: what is wrong and, behind the first semicolon outside of backticks, what to do next.
    pub fn of_file(name: &'static str, said: impl AsRef<str>, file: &Path) -> Self {
        let (what, next) = split_advice(said.as_ref());
        Self::in_file(name, what, file, next)
    }

    /// A file that the system does not let read.
    pub fn unreadable(error: &std::io::Error, file: &Path, next: &str) -> Self {
        let what = format!("cannot be read: {}", reason(error));
        Self::in_file("unreadable", what, file, next)
    }

    /// Bad input in a line of a log.
    pub fn log_line(
        name: &'static str,
        what: impl Into<String>,
        log: &Path,
        line: Option<u64>,
        next: impl Into<String>,
    ) -> Self {
        let mut failure = Self::in_file(name, what, log, next);
        failure.place.line = line;
        failure
    }

    /// Bad input at a line and a column of a file; column 0 is none.
    pub fn placed(
        name: &'static str,
        what: impl Into<String>,
        file: &Path,
        (line, column): (u64, u64),
        next: impl Into<String>,
    ) -> Self {
        let mut failure = Self::log_line(name, what, file, Some(line), next);
        failure.place.column = (column > 0).then_some(column);
        failure
    }

    /// A reading of a channel that is too large to be squared.
    pub fn overflow(what: String, channel: &str, log: &Path, line: Option<u64>) -> Self {
        let next = format!("correct the reading of {channel} or leave its cell empty");
        Self::log_line("overflow", what, log, line, next)
    }

    /// Bad arguments.
    pub fn command_line(
        name: &'static str,
        what: impl Into<String>,
        next: impl Into<String>,
    ) -> Self {
        Self::bad_input(name, what, "the command line", next)
    }

    /// Bad arguments in one text, as [`Error::of_file`] takes it.
    pub fn arguments(said: impl AsRef<str>) -> Self {
        let (what, next) = split_advice(said.as_ref());
        Self::command_line("arguments", what, next)
    }

    /// A request to stop while `out` was written.
    pub fn interrupted(out: &Path) -> Self {
        let what = "interrupted before the end; nothing was written";
        Self::in_file("interrupted", what, out, "run the command again")
            .of_kind(ErrorKind::Interrupted)
    }

    /// A request to stop while a log was worked on.
    pub(crate) fn unless_interrupted(interrupt: &Interrupt, log: &Path) -> Result<(), Self> {
        interrupt.check().map_err(|_| Self::interrupted(log))
    }

    /// A failure of the program itself; no input should lead here.
    pub fn internal(what: impl std::fmt::Display) -> Self {
        let next = "please report it with the device file and the log";
        Self::bad_input("internal", what.to_string(), "haptical itself", next)
            .of_kind(ErrorKind::Internal)
    }

    /// A refused calibration of a device from a log.
    pub fn calibration(error: &CalibrationError, device: &Path, log: &Path) -> Self {
        let (name, what, next) = describe(error);
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
        Self {
            kind: match error.is_unidentifiable() {
                true => ErrorKind::Unidentifiable,
                false => ErrorKind::BadInput,
            },
            name,
            what,
            place,
            next,
        }
    }

    /// A refused diagnosis of a device from a log.
    pub(crate) fn diagnosis(error: &DiagnosisError, device: &Path, log: &Path) -> Self {
        let text = error.to_string();
        let (name, next) = match error {
            DiagnosisError::Calibration(error) => return Self::calibration(error, device, log),
            DiagnosisError::Effect(error) => return Self::effect(error, device, log),
            DiagnosisError::Row { line, source } => {
                let what = source.to_string();
                return Self::log_line("row", what, log, Some(*line), LEAVE_ROW_OUT);
            }
            DiagnosisError::UnknownEffect { .. } => {
                let (what, next) = split_advice(&text);
                return Self::command_line("unknown-effect", what, next);
            }
            DiagnosisError::Identification(_) => {
                return Self::in_file("identification", text, log, CHECK_DEVICE);
            }
            DiagnosisError::NothingToSettle { why } => {
                let next = "record what `haptical diagnose` says under \"next\"";
                return Self::in_file("nothing-to-settle", why.clone(), log, next);
            }
            DiagnosisError::TooFewReadings { .. } => {
                let (what, next) = text.split_once(": ").unwrap_or((&text, "record more rows"));
                return Self::in_file("too-few-rows", what, log, next)
                    .of_kind(ErrorKind::Unidentifiable);
            }
            DiagnosisError::Torques { .. } => {
                let next = "haptical check says what such a log needs: a motion with times, [gravity] in the device \
                            file, and enough of it";
                ("torques-not-tested", next)
            }
            DiagnosisError::Commands { .. } => {
                let next = "record t_s, thetaN_rad and commandN_rad in radians of a joint that is moved through its range, with rests";
                ("commands-not-tested", next)
            }
            DiagnosisError::Currents { .. } => {
                let next = "record t_s, thetaN_rad, torqueN_nm and currentN_a of a joint that moves for some seconds";
                ("currents-not-tested", next)
            }
            other if other.is_unidentifiable() => {
                let next = "record slow motion of every joint through its whole range";
                ("nothing-identifiable", next)
            }
            _ => return Self::internal(text),
        };
        Self::in_file(name, text, log, next).of_kind(ErrorKind::Unidentifiable)
    }

    /// What kind of refusal it is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Name of the exact reason, for programs, such as `too-few-rows`.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What is wrong.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Where it is wrong.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// What to do next.
    pub fn next_step(&self) -> &str {
        &self.next
    }

    /// The same under the name of another reason.
    pub fn with_name(mut self, name: &'static str) -> Self {
        self.name = name;
        self
    }

    fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.kind = kind;
        self
    }
}

/// Place, what is wrong and what to do next, in one line.
impl std::fmt::Display for Error {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}: {}; {}", self.place, self.what, self.next)
    }
}

impl std::error::Error for Error {}

/// Name, what and next step of a refused calibration.
fn describe(error: &CalibrationError) -> (&'static str, String, String) {
    let text = error.to_string();
    let more = "record at many different poses that move every joint";
    let far = "the nominal device may be far from the real one: check its lengths, twists, home and \
               ratios against the device; with --loss squares, wild readings alone can do this: leave it at auto";
    let measure = "add external encoders (outN_rad), or [[link]] rows to the device and a distance \
                   (cable_m) or position (x_m, y_m, z_m) to the log; of torques alone (torqueN_nm), haptical diagnose tells \
                   what the arm carries and how its drives rub, and of commands (commandN_rad) how its joints follow them";
    let (name, what, next) = match error {
        CalibrationError::NoMotion { rows } => {
            let what = format!(
                "no joint moves in the log ({rows} rows at one pose), so nothing can be distinguished"
            );
            ("no-motion", what, more)
        }
        CalibrationError::TooFewRows {
            what,
            rows,
            parameters,
            advised,
        } => {
            let what = format!("{what}: {rows} readings cannot fix {parameters} parameters");
            let next = format!("record at least {advised} readings at different poses");
            return ("too-few-rows", what, next);
        }
        CalibrationError::NothingIdentifiable { .. } => ("nothing-identifiable", text, more),
        CalibrationError::NotConverged { what, reason } => {
            ("not-converged", format!("{what}: {reason}"), far)
        }
        CalibrationError::Identification { .. } => ("identification", text, CHECK_DEVICE),
        CalibrationError::Row { source, .. } => ("row", source.to_string(), LEAVE_ROW_OUT),
        CalibrationError::LooksLikeMillimetres { what, next, .. } => {
            ("looks-like-millimetres", what.clone(), *next)
        }
        CalibrationError::Rig { what, message } => {
            let split = message.rsplit_once(": ");
            let (message, next) = split.unwrap_or((message, "correct the rig or the log"));
            ("calibration", format!("{what}: {message}"), next)
        }
        CalibrationError::NoChannel => {
            let what = "the log has no measurement that this device can be identified from";
            ("no-channel", what.to_owned(), measure)
        }
        other => {
            let (name, text) = match other {
                CalibrationError::Reading { message, .. } => ("reading", message.clone()),
                CalibrationError::MistakenColumns { .. } | CalibrationError::MistakenLog { .. } => {
                    ("mistaken-columns", text)
                }
                _ => ("calibration", text.replacen(": ", "; ", 1)),
            };
            let (what, next) = split_advice(&text);
            return (name, what, next);
        }
    };
    (name, what, next.to_owned())
}

impl From<ReportError> for Error {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Write { path, source } => {
                let next = "give a file in a folder that can be written to and has room";
                let what = format!("cannot write: {}", reason(&source));
                Self::in_file("unwritable", what, &path, next)
            }
            other => Self::internal(other),
        }
    }
}

/// A message of the form "what; what to do". A semicolon between backticks belongs to what was
/// found in a file.
fn split_advice(text: &str) -> (String, String) {
    let even = |text: &str| text.matches('`').count().is_multiple_of(2);
    // A backtick in what was found makes the count odd; then the last semicolon is ours.
    let outside = |at: usize| even(&text[..at]) && even(&text[at..]);
    let mut all = text.match_indices("; ").map(|(at, _)| at);
    let at = all.find(|&at| outside(at)).or_else(|| text.rfind("; "));
    let (what, next) = at.map_or((text, "correct the input"), |at| {
        (&text[..at], &text[at + 2..])
    });
    (what.to_owned(), next.to_owned())
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
            Error::diagnosis(&error, Path::new("device.toml"), Path::new("log.csv"))
        };
        let few = refused(DiagnosisError::TooFewReadings {
            readings: 12,
            parameters: 57,
            advised: 1140,
        });
        assert_eq!(
            (few.kind, few.place.file.as_str()),
            (ErrorKind::Unidentifiable, "log.csv")
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
            (name.kind, name.name),
            (ErrorKind::BadInput, "unknown-effect")
        );
        assert_eq!(name.next, "did you mean `backlash`?");
        let still = refused(CalibrationError::NoMotion { rows: 400 }.into());
        assert_eq!(
            (still.kind, still.name),
            (ErrorKind::Unidentifiable, "no-motion")
        );
    }
}
