//! Lines to rows: those that are no rows, or out of order, are left out and counted.

use std::path::Path;

use haptical_data::{DataError, LoadedLog, LogShape, read_log_from};
use haptical_model::Recording;

use super::lines::Lines;
use crate::device::Device;
use crate::error::Error;

/// Rows before the first of their file's times that follow one another: then the clock was set back.
const CLOCK_WAS_SET: usize = 20;

/// What was left out.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct LeftOut {
    /// Lines that are no rows.
    pub unreadable: u64,
    /// Rows whose time is not after the one before.
    pub out_of_order: u64,
    /// What was wrong with the first of the former, and where.
    pub first: Option<String>,
}

impl LeftOut {
    /// Lines and rows.
    pub(super) fn count(&self) -> u64 {
        self.unreadable + self.out_of_order
    }
}

/// Reads lines.
#[derive(Debug, Clone, Default)]
pub(super) struct Intake {
    pub(super) left_out: LeftOut,
    last_s: Option<f64>,
    run: Option<i64>,
    /// Stretches whose times follow one another: files, and a clock that was set back.
    session: u32,
    /// Times of the last rows that were out of order.
    late_s: Vec<f64>,
    warnings: Vec<String>,
}

/// Rows that were read, with their lines.
pub(super) struct Rows {
    pub(super) recording: Recording,
    pub(super) header: String,
    pub(super) lines: Vec<String>,
    /// Said for the first time.
    pub(super) warnings: Vec<String>,
}

impl Intake {
    /// A new file begins: its times are its own.
    pub(super) fn new_file(&mut self) {
        self.last_s = None;
        self.run = None;
        self.session += 1;
        self.late_s.clear();
    }

    /// The rows among the lines. Where the log has no runs they get one for each stretch whose times follow one another, so
    /// that rows of several can be read together.
    ///
    /// # Errors
    /// The header is none of this device.
    pub(super) fn read(
        &mut self,
        part: Lines,
        file: &str,
        shape: &LogShape,
        device: &Device,
    ) -> Result<Option<Rows>, Error> {
        let (mut header, first_line, mut lines) = (part.header, part.first_line, part.lines);
        let is_run = |name: &str| name.trim().trim_matches('"') == "run";
        let has_runs = header.split(',').any(is_run);
        if !has_runs {
            header += ",run";
            lines = lines.iter().map(|line| self.with_run(line)).collect();
        }
        let run_at = header.split(',').position(is_run).unwrap_or_default();
        let parse = |lines: &[String]| parsed(&header, lines, run_at, (file, shape));
        match parse(&lines) {
            Ok(log) if self.is_in_order(&log.recording) => {
                self.accept(&log.recording);
                return Ok(Some(self.rows(log, header, lines, (file, first_line))));
            }
            // a header that fits no device is no matter of single lines
            Err(error) if error.line().is_none_or(|line| line <= 1) => {
                return Err(Error::log(error, device));
            }
            _ => {}
        }
        let mut number = first_line;
        lines.retain_mut(|line| {
            let at = number;
            number += 1;
            match parse(std::slice::from_ref(line)) {
                Ok(log) if log.recording.len() == 1 => {
                    let session = self.session;
                    let takes = self.takes_in_order(&log.recording);
                    if !has_runs && self.session != session {
                        let cells = line.rsplit_once(',').map_or("", |(cells, _)| cells);
                        *line = self.with_run(cells);
                    }
                    takes
                }
                Ok(_) => self.leave_out(|| format!("{file}, line {at}: no row")),
                Err(error) => self.leave_out(|| format!("{file}, line {at}: {}", error.fault)),
            }
        });
        if lines.is_empty() {
            return Ok(None);
        }
        match parse(&lines) {
            Ok(log) => Ok(Some(self.rows(log, header, lines, (file, first_line)))),
            // each line is a row, and together they are no log: runs that are interrupted
            Err(error) => {
                self.left_out.unreadable += lines.len() as u64;
                self.left_out.first.get_or_insert_with(|| error.to_string());
                Ok(None)
            }
        }
    }

    fn with_run(&self, line: &str) -> String {
        format!("{line},{}", self.session)
    }

    fn rows(
        &mut self,
        log: LoadedLog,
        header: String,
        lines: Vec<String>,
        (file, first_line): (&str, u64),
    ) -> Rows {
        let mut recording = log.recording;
        for line in &mut recording.line {
            *line = (*line + first_line).saturating_sub(3);
        }
        Rows {
            recording,
            header,
            lines,
            warnings: self.new_warnings(log.warnings, file),
        }
    }

    fn leave_out(&mut self, why: impl FnOnce() -> String) -> bool {
        self.left_out.unreadable += 1;
        self.left_out.first.get_or_insert_with(why);
        false
    }

    /// Counts lines that were left out before they came here.
    pub(super) fn add_unreadable(&mut self, count: u64) {
        if count > 0 {
            self.left_out.unreadable += count;
            let why = || "a line longer than 1 MiB, or no flat JSON object".to_owned();
            self.left_out.first.get_or_insert_with(why);
        }
    }

    fn is_in_order(&self, recording: &Recording) -> bool {
        let first = recording.time_s.as_ref().and_then(|times| times.first());
        let runs = recording.run.as_ref();
        let is_new_run = runs.is_some_and(|runs| runs.first().copied() != self.run);
        match (first, self.last_s) {
            (Some(first), Some(last)) => is_new_run || first.is_nan() || *first > last,
            _ => true,
        }
    }

    fn accept(&mut self, recording: &Recording) {
        let times = recording.time_s.iter().flatten();
        if let Some(last) = times.rev().find(|time| time.is_finite()) {
            self.last_s = Some(*last);
        }
        self.run = recording.run.as_ref().and_then(|runs| runs.last().copied());
        self.late_s.clear();
    }

    /// Of a single row; takes it where it is.
    fn takes_in_order(&mut self, recording: &Recording) -> bool {
        if !self.is_in_order(recording) {
            self.left_out.out_of_order += 1;
            let time = recording.time_s.as_ref().map_or(f64::NAN, |times| times[0]);
            if self.late_s.last().is_some_and(|last| time <= *last) {
                self.late_s.clear();
            }
            self.late_s.push(time);
            if self.late_s.len() < CLOCK_WAS_SET {
                return false;
            }
            self.left_out.out_of_order -= 1;
            self.session += 1;
        }
        self.accept(recording);
        true
    }

    /// Those that were not said before, without the line: columns that are left out.
    fn new_warnings(&mut self, warnings: Vec<String>, file: &str) -> Vec<String> {
        // of a few rows: the next ones may have a reading
        let is_of_file = |warning: &String| !warning.contains("no row has a reading");
        let mut new = Vec::new();
        for warning in warnings.into_iter().filter(is_of_file) {
            let words = warning.replace(file, "");
            let words = words.replace(|letter: char| letter.is_ascii_digit(), "");
            if self.warnings.len() < 100 && !self.warnings.contains(&words) {
                self.warnings.push(words);
                new.push(warning);
            }
        }
        new
    }
}

/// Rows of lines. A log has two rows at least, and one may come alone: the first is read twice, as a run of its own.
fn parsed(
    header: &str,
    lines: &[String],
    run_at: usize,
    (file, shape): (&str, &LogShape),
) -> Result<LoadedLog, DataError> {
    let first = lines.first().map_or("", String::as_str);
    let text = format!(
        "{header}\n{}\n{}\n",
        in_own_run(first, run_at),
        lines.join("\n")
    );
    let mut log = read_log_from(text.as_bytes(), file, shape)?;
    let rows: Vec<usize> = (1..log.recording.len()).collect();
    log.recording = log.recording.select(&rows);
    Ok(log)
}

/// The line as one of a run that no log has.
fn in_own_run(line: &str, run_at: usize) -> String {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line.as_bytes());
    let Some(Ok(cells)) = reader.records().next() else {
        return line.to_owned();
    };
    let own = (i64::MIN + 1).to_string();
    let cells = cells.iter().enumerate();
    let cells = cells.map(|(at, cell)| if at == run_at { own.as_str() } else { cell });
    let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
    let written = writer.write_record(cells).ok();
    let written = written.and_then(|()| writer.into_inner().ok());
    let text = written.map(|bytes| String::from_utf8_lossy(&bytes).trim_end().to_owned());
    text.unwrap_or_else(|| line.to_owned())
}

/// A log of torques alone, or of postures that touch.
pub(super) fn nothing_to_watch(recording: &Recording, file: &Path) -> Error {
    let said = match recording.torque_nm.iter().any(Option::is_some) {
        true => {
            "the log has torques and nothing that says where the links are: torques of a moving arm are not watched; judge it with \
             `haptical diagnose`, or record an external encoder (out1_rad), a cable (cable_m) or a tracker (x_m, y_m, z_m) too"
        }
        false => {
            "the log has no reading that the device predicts; record an external encoder (out1_rad), a cable (cable_m) or a \
             tracker (x_m, y_m, z_m)"
        }
    };
    Error::of_file("nothing-to-watch", said, file)
}
