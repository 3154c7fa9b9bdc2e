//! A path as a table: joint angles, or poses of the handle, row by row.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use haptical_data::Cells;
use haptical_model::Recording;

use super::COMMAND_PLACE;
use crate::device::Device;
use crate::error::Error;
use crate::files::Source;
use crate::log::Log;

/// Longest first line \[bytes\].
const LONGEST_HEADER: u64 = 64 << 10;

/// Waypoints of a path.
#[derive(Debug, Clone)]
pub struct Waypoints {
    /// Readings as the nominal device means them, poses, and the conditions of each row.
    pub log: Log,
    /// Whether the poses are what is wanted, not the readings.
    pub has_poses: bool,
    /// Whether the readings are known: a table of poses may have them as start values.
    pub has_readings: bool,
}

impl Waypoints {
    /// Reads a path: columns of joint readings as of a log (`theta1_rad`), or of the handle's poses in the frame of the base
    /// (`x_m,y_m,z_m`, with `qw,qx,qy,qz` or without), or both: then the poses are the path, and the search starts from the
    /// readings. Conditions that bend the arm (`torque1_nm`, `fx_n`, `temp_degc`) may stand beside them.
    ///
    /// # Errors
    /// A file that cannot be read or is no such table, with line and column.
    pub fn read(source: &Source, device: &Device) -> Result<Self, Error> {
        let names = device.joint_columns();
        let text = table_of_poses(source, &names)?;
        let has_readings = text.is_none();
        let log = match &text {
            // the columns that a log must have are added behind those of the table
            Some(text) => {
                let mut log = Log::from_text(&with_columns(text, &names), source, device)?;
                log.warnings.retain(|own| !own.contains("theta"));
                log
            }
            None => Log::open(source, device)?,
        };
        let place = source.path.as_path();
        let recording = &log.recording;
        if recording.is_empty() {
            let said = "there are no waypoints; give a row for each waypoint";
            return Err(Error::of_file("no-rows", said, place));
        }
        let has_poses = recording.position_m.is_some();
        if !has_poses && recording.orientation_wxyz.is_some() {
            let said = "there are orientations without positions; add the columns x_m, y_m, z_m";
            return Err(Error::of_file("no-positions", said, place));
        }
        let waypoints = Self {
            has_poses,
            has_readings,
            log,
        };
        waypoints.refuse_gaps()?;
        Ok(waypoints)
    }

    /// Takes columns in memory, readings or poses, by their names in a file; messages call them by `name`.
    ///
    /// # Errors
    /// As [`Waypoints::read`].
    pub fn from_columns(
        columns: &[(&str, Cells<'_>)],
        name: &str,
        device: &Device,
    ) -> Result<Self, Error> {
        let names = device.joint_columns();
        let is_joint = |own: &str| names.iter().any(|name| name == own);
        let has_readings = columns.iter().any(|(own, _)| is_joint(own));
        let rows = columns.first().map_or(0, |(_, cells)| match cells {
            Cells::Numbers(cells) => cells.len(),
            Cells::Integers(cells) => cells.len(),
            Cells::Texts(cells) => cells.len(),
            _ => 0,
        });
        let zeros = vec![0.0; rows];
        let mut all = columns.to_vec();
        if !has_readings {
            let names = names.iter().map(String::as_str);
            all.extend(names.map(|name| (name, Cells::Numbers(&zeros))));
        }
        let waypoints = Self::from_log(Log::from_columns(&all, name, device)?)?;
        Ok(Self {
            has_readings,
            ..waypoints
        })
    }

    /// Readings in memory as waypoints; poses where the recording has positions.
    ///
    /// # Errors
    /// As [`Waypoints::read`].
    pub fn from_log(log: Log) -> Result<Self, Error> {
        let waypoints = Self {
            has_poses: log.recording.position_m.is_some(),
            has_readings: true,
            log,
        };
        waypoints.refuse_gaps()?;
        Ok(waypoints)
    }

    /// Refuses rows of which the pose is wanted and lacks a number.
    fn refuse_gaps(&self) -> Result<(), Error> {
        let recording = &self.log.recording;
        if !self.has_poses {
            return Ok(());
        }
        let lacks = |row: usize| {
            let position = recording.position_m.iter().flatten();
            let mut all = position.chain(recording.orientation_wxyz.iter().flatten());
            all.any(|column| !column[row].is_finite())
        };
        let (what, next) = (
            "the waypoint's pose is not complete",
            "fill the cells in, or leave the row out",
        );
        match (0..recording.len()).find(|row| lacks(*row)) {
            None => Ok(()),
            Some(row) => Err(self.log.refuse_row("no-pose", what, row, next)),
        }
    }

    /// The rows.
    pub fn recording(&self) -> &Recording {
        &self.log.recording
    }
}

/// The text of a table with positions and without readings of joints; none for any other file, which is read as a log is.
fn table_of_poses(source: &Source, joints: &[String]) -> Result<Option<String>, Error> {
    let is_one = |header: &str| {
        let header = header.trim_start_matches('\u{feff}');
        let names = header.split(',').map(|name| name.trim().trim_matches('"'));
        let names: Vec<&str> = names.collect();
        let has = |wanted: &str| names.contains(&wanted);
        has("x_m") && !joints.iter().any(|own| has(own))
    };
    if let Some(text) = &source.text {
        let header = text.lines().next().unwrap_or_default();
        return Ok(is_one(header).then(|| text.clone()));
    }
    // a pipe is read once; what is no text, or is not there, is for the reader of logs to say
    let file = File::open(&source.path).ok();
    let Some(file) = file.filter(|_| source.path.is_file()) else {
        return Ok(None);
    };
    let mut header = Vec::new();
    let mut first = BufReader::new(file).take(LONGEST_HEADER);
    if first.read_until(b'\n', &mut header).is_err() || !is_one(&String::from_utf8_lossy(&header)) {
        return Ok(None);
    }
    let text = std::fs::read_to_string(&source.path);
    let next = "give a table as CSV in UTF-8";
    text.map(Some)
        .map_err(|error| Error::unreadable(&error, &source.path, next))
}

/// The table with columns of zeros.
fn with_columns(text: &str, names: &[String]) -> String {
    let zeros = ",0".repeat(names.len());
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let rows = lines.map(|line| match line.trim().is_empty() {
        true => format!("{line}\n"),
        false => format!("{line}{zeros}\n"),
    });
    format!("{header},{}\n{}", names.join(","), rows.collect::<String>())
}

/// What a refusal says of unreachable rows.
pub(super) fn unreachable(rows: &[(u64, usize, String)], count: usize, source: &Source) -> Error {
    const MOST_NAMED: usize = 5;
    let named = rows.iter().take(MOST_NAMED);
    let named = named.map(|(line, row, rest)| format!("row {row} (line {line}): {rest}"));
    let mut named: Vec<String> = named.collect();
    if rows.len() > MOST_NAMED {
        named.push(format!("and {} more", rows.len() - MOST_NAMED));
    }
    let what = format!(
        "{} of {count} waypoints are out of reach of the corrected model within its joint limits: {}",
        rows.len(),
        named.join("; ")
    );
    let (line, next) = (rows.first(), format!("move them, {COMMAND_PLACE}"));
    let line = line.map(|(line, ..)| *line);
    Error::log_line("unreachable", what, &source.path, line, next)
}
