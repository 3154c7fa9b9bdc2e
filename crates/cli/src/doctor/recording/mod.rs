//! A recording of many episodes: a LeRobot data set, a log with runs, or a folder of logs.

#[cfg(any(feature = "mcap", feature = "rosbag2"))]
mod bags;
mod logs;
mod tables;

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::flags::{MOST_PERCENT, Units, word};
#[cfg(feature = "parquet")]
use crate::import::lerobot;

/// Largest number of radians.
const MOST_RAD: f64 = 7.0;

/// What the numbers are in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Radians,
    Degrees,
    Percent,
    /// Degrees or percent.
    Unknown,
}

/// The rows of all episodes, one after the other.
#[derive(Debug)]
pub(super) struct Recorded {
    /// What it is, in words.
    pub(super) kind: String,
    pub(super) names: Vec<String>,
    pub(super) unit: Unit,
    pub(super) time_s: Vec<f64>,
    pub(super) position: Vec<Vec<f64>>,
    /// As many as positions, or none.
    pub(super) command: Vec<Vec<f64>>,
    pub(super) episodes: Vec<Range<usize>>,
    /// Rows that the data set's description says each episode has; empty where it says nothing.
    pub(super) described_rows: Vec<usize>,
    /// What each episode is called: the data set's numbers, or the logs' names.
    pub(super) labels: Vec<Label>,
    pub(super) warnings: Vec<String>,
}

/// What an episode is called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Label {
    Number(i64),
    File(String),
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::File(name) => f.write_str(name),
        }
    }
}

impl Recorded {
    /// Unit of a joint: grippers of arms in degrees are in percent of their range.
    pub(super) fn unit_of(&self, joint: usize) -> Unit {
        let is_gripper = self.names[joint].to_ascii_lowercase().contains("gripper");
        match self.unit {
            Unit::Degrees | Unit::Unknown if is_gripper => Unit::Percent,
            unit => unit,
        }
    }
}

impl Unit {
    /// 1.5 degrees: half of the least fault that matters; of percent as much of a range of a third of a turn.
    pub(super) fn least_offset(self) -> f64 {
        match self {
            Self::Radians => 1.5_f64.to_radians(),
            Self::Degrees | Self::Percent | Self::Unknown => 1.5,
        }
    }

    fn of(numbers: &[&[Vec<f64>]], asked: Option<Units>) -> Self {
        let all = numbers.iter().flat_map(|columns| columns.iter().flatten());
        let largest = all
            .filter(|value| value.is_finite())
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        match asked {
            Some(Units::Radians) => Self::Radians,
            Some(Units::Degrees) => Self::Degrees,
            Some(Units::Percent) => Self::Percent,
            None if largest <= MOST_RAD => Self::Radians,
            None if largest > MOST_PERCENT => Self::Degrees,
            None => Self::Unknown,
        }
    }
}

/// Reads what is at a path, and checks that there is something to look at.
pub(super) fn read(
    path: &Path,
    keys: [Option<&str>; 2],
    units: Option<Units>,
) -> Result<Recorded, Failure> {
    let mut recorded = of_path(path, keys, units)?;
    for name in &mut recorded.names {
        // what is read is shown in tables
        *name = name
            .chars()
            .map(|letter| if letter.is_control() { ' ' } else { letter })
            .collect();
    }
    let has_finite = |columns: &[Vec<f64>]| {
        columns
            .iter()
            .any(|column| column.iter().any(|value| value.is_finite()))
    };
    if !has_finite(&recorded.position)
        || !(recorded.command.is_empty() || has_finite(&recorded.command))
    {
        let said = "none of its joints has a number; give a recording with positions";
        return Err(Failure::of_file("no-data-set", said, path));
    }
    Ok(recorded)
}

fn of_path(
    path: &Path,
    keys: [Option<&str>; 2],
    units: Option<Units>,
) -> Result<Recorded, Failure> {
    if !path.exists() {
        let said =
            "there is no such file or folder; give a LeRobot data set, a log, or a folder of logs";
        return Err(Failure::of_file("no-data-set", said, path));
    }
    let form = Form::of(path)?;
    #[cfg(feature = "parquet")]
    if let Form::DataSet = form {
        return data_set(path, keys, units);
    }
    let _ = keys;
    let Form::Logs(files) = form else {
        let said = "this build reads no Parquet, which a LeRobot data set is; build with the feature `parquet`";
        return Err(Failure::of_file("no-data-set", said, path));
    };
    logs::read(&files, units)
}

/// What is at a path.
enum Form {
    DataSet,
    Logs(Vec<PathBuf>),
}

/// Ends of the names of tables and of bags.
const TABLES: [&str; 7] = [".csv", ".csv.gz", ".tsv", ".xlsx", ".npz", ".mat", ".jsonl"];
const BAGS: [&str; 2] = [".mcap", ".db3"];

fn ends_with(path: &Path, ends: &[&str]) -> bool {
    let name = path
        .file_name()
        .and_then(|name| name.to_str())
        .unwrap_or_default();
    let name = name.to_ascii_lowercase();
    ends.iter().any(|end| name.ends_with(end))
}

impl Form {
    fn of(path: &Path) -> Result<Self, Failure> {
        if !path.is_dir() {
            return Ok(match ends_with(path, &[".parquet"]) {
                true => Self::DataSet,
                false => Self::Logs(vec![path.to_owned()]),
            });
        }
        let is_data_set = |folder: &Path| folder.join("meta/info.json").is_file();
        if is_data_set(path) {
            return Ok(Self::DataSet);
        }
        let next = "give a LeRobot data set, or a folder of logs";
        let entries =
            std::fs::read_dir(path).map_err(|error| Failure::unreadable(&error, path, next))?;
        let mut entries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        entries.sort_by_key(|path| natural(path));
        let sets: Vec<String> = entries
            .iter()
            .filter(|entry| is_data_set(entry))
            .map(|entry| word(entry))
            .collect();
        let logs: Vec<PathBuf> = entries
            .into_iter()
            .filter(|entry| entry.is_dir() || ends_with(entry, &TABLES) || ends_with(entry, &BAGS))
            .collect();
        let logs: Vec<PathBuf> = logs
            .into_iter()
            .flat_map(|entry| files_of(&entry))
            .collect();
        match (&sets[..], logs.is_empty()) {
            ([], false) => Ok(Self::Logs(logs)),
            ([], true) => {
                let said = "the folder has neither meta/info.json, as a LeRobot data set has, nor logs (.csv, .mcap, .db3, .xlsx, .npz, \
                            .mat, .jsonl); give the folder that holds meta/ and data/, or a folder of logs";
                Err(Failure::of_file("no-data-set", said, path))
            }
            _ => {
                let said = format!(
                    "the folder holds {} data sets: give one of them, {}",
                    sets.len(),
                    sets.join(" or ")
                );
                Err(Failure::of_file("several-data-sets", &said, path))
            }
        }
    }
}

/// A file, or the bag in a folder of rosbag2.
fn files_of(entry: &Path) -> Vec<PathBuf> {
    if !entry.is_dir() {
        return vec![entry.to_owned()];
    }
    if !entry.join("metadata.yaml").is_file() {
        return Vec::new();
    }
    let inside = std::fs::read_dir(entry)
        .into_iter()
        .flatten()
        .flatten()
        .map(|inner| inner.path());
    let mut bags: Vec<PathBuf> = inside.filter(|inner| ends_with(inner, &BAGS)).collect();
    bags.sort();
    bags
}

/// A name with its numbers in their order: `run_2` comes before `run_10`.
fn natural(path: &Path) -> Vec<(String, u64)> {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let mut parts: Vec<(String, u64)> = vec![(String::new(), 0)];
    let mut in_number = false;
    for letter in name.chars() {
        match (letter.to_digit(10), parts.last_mut()) {
            (Some(digit), Some(last)) => {
                last.1 = last.1.saturating_mul(10).saturating_add(u64::from(digit));
                in_number = true;
            }
            (None, Some(last)) if !in_number => last.0.push(letter),
            _ => {
                parts.push((letter.to_string(), 0));
                in_number = false;
            }
        }
    }
    parts
}

#[cfg(feature = "parquet")]
fn data_set(
    path: &Path,
    keys: [Option<&str>; 2],
    units: Option<Units>,
) -> Result<Recorded, Failure> {
    let read = lerobot::read_rows(path, keys)?;
    let mut rows = read.rows;
    let is_sorted = rows.sort();
    let (episodes, labels) = runs(&rows.episode);
    let mut warnings = Vec::new();
    if rows.action.is_empty() {
        warnings.push(format!(
            "the data set has no commands of these joints; its keys are {}: give --action",
            rows.known.join(", ")
        ));
    }
    if !is_sorted {
        warnings.push(
            "the rows of its episodes are not in the order of time; they were sorted".to_owned(),
        );
    }
    let described = |label: &i64| read.lengths.get(label).copied();
    let described_rows: Option<Vec<usize>> = labels.iter().map(described).collect();
    let unit = Unit::of(&[&rows.state, &rows.action], units);
    Ok(Recorded {
        kind: "LeRobot data set".to_owned(),
        names: read.names,
        unit,
        time_s: rows.time_s,
        position: rows.state,
        command: rows.action,
        episodes,
        described_rows: described_rows.unwrap_or_default(),
        labels: labels.into_iter().map(Label::Number).collect(),
        warnings,
    })
}

/// Rows and number of each stretch of one number.
fn runs(numbers: &[i64]) -> (Vec<Range<usize>>, Vec<i64>) {
    let mut start = 0;
    let chunks = numbers.chunk_by(|a, b| a == b).map(|chunk| {
        let rows = start..start + chunk.len();
        start = rows.end;
        (rows, chunk[0])
    });
    chunks.unzip()
}
