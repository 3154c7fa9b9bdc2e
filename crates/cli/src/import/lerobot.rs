//! A LeRobot data set (versions 2 and 3) to a CSV log: `action` is the command, `observation.state` the joints, an episode a run.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use haptical_data::read_parquet_columns;
use haptical_model::{Device, JointType, Recording};
use serde_json::Value;

use super::{Imported, Target, shape_without_limits};
use crate::failure::Failure;
use crate::flags::DeviceOptions;

/// End of the help of `haptical import lerobot`.
pub(super) const HELP: &str = "\
Example:
  haptical import lerobot my_dataset --units degrees --out log.csv
  haptical import lerobot file-000.parquet --units percent --device arm.urdf --out log.csv

The joints are in the order of the data set. Percent (-100 to 100, a gripper 0 to 100) is of the range between a
joint's limits in --device, which must be the range that the servo was calibrated to.";

/// Flags of `haptical import lerobot`.
#[derive(Debug, Args)]
pub(super) struct LerobotArguments {
    /// Data set (a folder with meta/info.json and data/), or one of its Parquet files
    #[arg(value_name = "PATH")]
    dataset: PathBuf,
    #[command(flatten)]
    target: Target,
    /// Unit of its numbers; without it degrees where a number is beyond 101, else it must be said
    #[arg(long)]
    units: Option<Units>,
    /// Device file (TOML, URDF or MJCF), for the limits that percent are of
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    #[command(flatten)]
    device_options: DeviceOptions,
}

/// Units of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Units {
    /// Degrees
    Degrees,
    /// -100 to 100 between the joint's limits; 0 to 100 for a gripper
    Percent,
    /// Radians
    Radians,
}

/// No joint turns by more percent.
const MOST_PERCENT: f64 = 101.0;
/// Columns of a data set.
const LISTS: [&str; 2] = ["action", "observation.state"];
const NUMBERS: [&str; 2] = ["timestamp", "episode_index"];

/// Runs the command.
pub(super) fn run(arguments: &LerobotArguments) -> Result<(), Failure> {
    arguments.target.check(None)?;
    let info = info(&arguments.dataset)?;
    let table = Table::read(&arguments.dataset)?;
    let joints = table.state.len();
    let names = names(info.as_ref(), joints);
    let device = arguments.device.as_ref();
    let device = device.map(|path| arguments.device_options.read_by_path(path));
    let device = device.transpose()?;
    let units = units(arguments, &table)?;
    let model = device.as_ref().map(|device| &device.model);
    let scales = scales(arguments, units, &names, model)?;
    let scaled = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let all = columns.iter().zip(&scales);
        all.map(|(column, (factor, zero))| column.iter().map(|own| own * factor + zero).collect())
            .collect()
    };
    let command = scaled(&table.action).into_iter().enumerate();
    let rows = table.time_s.len();
    let recording = Recording {
        line: (2..rows as u64 + 2).collect(),
        time_s: Some(table.time_s),
        run: Some(table.episode),
        joint: scaled(&table.state),
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        covariates: command
            .map(|(joint, column)| (format!("command{}_rad", joint + 1), column))
            .collect(),
        ..Recording::default()
    };
    let mut shape = shape_without_limits(&vec![false; joints], 0);
    for (joint, name) in shape.joints.iter_mut().zip(&names) {
        joint.name.clone_from(name);
    }
    let mut warnings = device.map_or_else(Vec::new, |device| device.warnings);
    let listed = names.iter().enumerate();
    let listed: Vec<String> = listed
        .map(|(joint, name)| format!("theta{} is {name}", joint + 1))
        .collect();
    let listed = listed.join(", ");
    warnings.push(format!("the joints by their columns: {listed}"));
    let imported = Imported::of(&recording, &shape, warnings)?;
    arguments.target.write(imported)
}

/// The description of a data set; none of a single file without one above it.
fn info(dataset: &Path) -> Result<Option<Value>, Failure> {
    let folders = dataset.ancestors().take(4);
    let mut paths = folders.map(|folder| folder.join("meta/info.json"));
    let Some(path) = paths.find(|path| path.is_file()) else {
        let said = "the folder has no meta/info.json, so it is no LeRobot data set; give the folder that holds meta/ and data/, or a \
                    Parquet file";
        return match dataset.is_dir() {
            true => Err(Failure::of_file("no-data-set", said, dataset)),
            false => Ok(None),
        };
    };
    let next = "give the data set as LeRobot wrote it";
    let unreadable = |error| Failure::unreadable(&error, &path, next);
    let text = std::fs::read_to_string(&path).map_err(unreadable)?;
    let value = serde_json::from_str(&text).map_err(|error| {
        Failure::in_file("no-json", format!("it is no JSON: {error}"), &path, next)
    });
    value.map(Some)
}

/// Names of the joints: those of the feature's list, else numbers.
fn names(info: Option<&Value>, joints: usize) -> Vec<String> {
    let feature = info.and_then(|info| info.get("features")?.get("observation.state"));
    let names = feature.and_then(|feature| feature.get("names"));
    let listed = match names {
        Some(Value::Array(names)) => Some(names),
        // older ones have the list below the kind of the names
        Some(Value::Object(kinds)) => kinds.values().find_map(Value::as_array),
        _ => None,
    };
    let own: Vec<String> = (listed.into_iter().flatten())
        .filter_map(|name| Some(name.as_str()?.trim_end_matches(".pos").to_owned()))
        .collect();
    match own.len() == joints {
        true => own,
        false => (1..=joints).map(|joint| joint.to_string()).collect(),
    }
}

/// The rows of all files.
struct Table {
    action: Vec<Vec<f64>>,
    state: Vec<Vec<f64>>,
    time_s: Vec<f64>,
    episode: Vec<i64>,
}

impl Table {
    fn read(dataset: &Path) -> Result<Self, Failure> {
        let files = files(dataset)?;
        let mut all: Option<Self> = None;
        for file in &files {
            let own = Self::of_file(file)?;
            match &mut all {
                None => all = Some(own),
                Some(all) => all.extend(own, file)?,
            }
        }
        all.ok_or_else(|| {
            let said = "the data set has no Parquet file in data/; give a data set that was recorded, with its data";
            Failure::of_file("no-data-set", said, dataset)
        })
    }

    fn of_file(path: &Path) -> Result<Self, Failure> {
        let read = read_parquet_columns(path, &LISTS, &NUMBERS)?;
        let refused = |what: String| {
            let next = "give a data set whose actions are positions of the joints that it observes";
            Failure::in_file("no-data-set", what, path, next)
        };
        let mut lists = read.lists.into_iter();
        let mut list = || lists.next().unwrap_or_default();
        let (action, state) = (list(), list());
        if action.len() != state.len() || state.is_empty() {
            let (actions, states) = (action.len(), state.len());
            let what = format!("it has {actions} actions and {states} states in a row");
            return Err(refused(what));
        }
        let mut numbers = read.numbers.into_iter();
        let Some(time_s) = numbers.next().flatten() else {
            return Err(refused("it has no column `timestamp`".to_owned()));
        };
        let episode = numbers.next().flatten();
        let rows = time_s.len();
        let episode = episode.map_or(vec![0; rows], |column| {
            column.iter().map(|value| *value as i64).collect()
        });
        Ok(Self {
            action,
            state,
            time_s,
            episode,
        })
    }

    fn extend(&mut self, other: Self, path: &Path) -> Result<(), Failure> {
        if other.state.len() != self.state.len() {
            let (own, before) = (other.state.len(), self.state.len());
            let said = format!(
                "it has {own} joints, the files before it {before}; give the files of one robot"
            );
            return Err(Failure::of_file("no-data-set", said, path));
        }
        let pairs = (self.action.iter_mut().zip(other.action))
            .chain(self.state.iter_mut().zip(other.state));
        pairs.for_each(|(own, more)| own.extend(more));
        self.time_s.extend(other.time_s);
        self.episode.extend(other.episode);
        Ok(())
    }

    fn largest(&self) -> f64 {
        let all = self.action.iter().chain(&self.state).flatten();
        all.fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// The Parquet files of a data set, in the order of their names.
fn files(dataset: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !dataset.is_dir() {
        return Ok(vec![dataset.to_owned()]);
    }
    let mut found = Vec::new();
    let mut folders = vec![dataset.join("data")];
    while let Some(folder) = folders.pop() {
        let next = "give the folder that holds meta/ and data/";
        let entries = std::fs::read_dir(&folder)
            .map_err(|error| Failure::unreadable(&error, &folder, next))?;
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "parquet") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn units(arguments: &LerobotArguments, table: &Table) -> Result<Units, Failure> {
    if let Some(units) = arguments.units {
        return Ok(units);
    }
    let largest = table.largest();
    if largest > MOST_PERCENT {
        return Ok(Units::Degrees);
    }
    Err(Failure::arguments(format!(
        "the data set does not say its units: its largest number is {largest:.1}, which may be degrees, percent or radians; say --units \
         degrees, percent or radians, as the robot was configured when it was recorded"
    )))
}

/// Factor and zero of each joint.
fn scales(
    arguments: &LerobotArguments,
    units: Units,
    names: &[String],
    device: Option<&Device>,
) -> Result<Vec<(f64, f64)>, Failure> {
    match units {
        Units::Radians => return Ok(vec![(1.0, 0.0); names.len()]),
        Units::Degrees => return Ok(vec![(1_f64.to_radians(), 0.0); names.len()]),
        Units::Percent => {}
    }
    let Some(device) = device else {
        let said = "percent are of a joint's range, which the data set does not say; give --device with the limits that the servos \
                    were calibrated to";
        return Err(Failure::arguments(said));
    };
    let path = arguments.device.as_deref().unwrap_or(&arguments.dataset);
    if device.joints.len() != names.len() {
        let (own, wanted) = (device.joints.len(), names.len());
        let said = format!(
            "the device has {own} joints, the data set {wanted}; give the device that was recorded"
        );
        return Err(Failure::of_file("other-device", said, path));
    }
    let pairs = device.joints.iter().zip(names);
    pairs
        .map(|(joint, name)| {
            let ends = [joint.lower_rad, joint.upper_rad].map(|end| joint.home_rad + end);
            let range = ends[1] - ends[0];
            if !range.is_finite() || joint.joint_type == JointType::Prismatic {
                let what = format!(
                    "joint `{}` has no limits, and percent are of its range",
                    joint.name
                );
                let next = "give its limits in the device file, or record in degrees";
                return Err(Failure::in_file("no-limits", what, path, next));
            }
            Ok(match name.contains("gripper") {
                true => (range / 100.0, ends[0]),
                false => (range / 200.0, 0.5 * (ends[0] + ends[1])),
            })
        })
        .collect()
}
