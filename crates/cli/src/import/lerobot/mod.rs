//! A LeRobot data set (versions 2 and 3) to a CSV log: `action` is the command, `observation.state` the joints, an episode a run.

mod keys;
mod order;
mod rows;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use haptical_data::read_parquet_columns;
use haptical_model::{Device, JointType, Recording};
use serde_json::Value;

use self::order::order;
use self::rows::Rows;
use super::{Imported, Target, shape_without_limits};
use crate::failure::Failure;
use crate::flags::{DeviceOptions, MOST_PERCENT, Units};

/// End of the help of `haptical import lerobot`.
pub(super) const HELP: &str = "\
Example:
  haptical import lerobot my_dataset --units degrees --out log.csv
  haptical import lerobot file-000.parquet --units percent --device arm.urdf --out log.csv

With --device, a URDF for example, joints have the device's order by their names, and others, a gripper for example, are left out;
else they have the data set's. Percent (-100 to 100, a gripper 0 to 100) is of the range between a
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
    /// Device file (TOML, URDF or MJCF): its joints by their names, and the limits that percent are of
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// The data set's joints that are written, in this order: names or numbers from 1
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    joints: Vec<String>,
    /// Key of the joints' positions; without it `observation.state` or the key of such words
    #[arg(long, value_name = "KEY")]
    state: Option<String>,
    /// Key of their commands; without it `action` or the key of such words
    #[arg(long, value_name = "KEY")]
    action: Option<String>,
    #[command(flatten)]
    device_options: DeviceOptions,
}

/// Runs the command.
pub(super) fn run(arguments: &LerobotArguments) -> Result<(), Failure> {
    arguments.target.check(None)?;
    let info = info(&arguments.dataset)?;
    let asked = [&arguments.state, &arguments.action].map(Option::as_deref);
    let rows = Rows::read(&arguments.dataset, asked, frames_per_second(info.as_ref()))?;
    let keys = &rows.keys;
    let all = names(info.as_ref(), &keys.state, rows.state.len());
    let device = arguments.device.as_ref();
    let device = device.map(|path| arguments.device_options.read_by_path(path));
    let device = device.transpose()?;
    let model = device.as_ref().map(|device| &device.model);
    let order = order(
        &all,
        &arguments.joints,
        model.zip(arguments.device.as_deref()),
    )?;
    let chosen: Vec<String> = order
        .places
        .iter()
        .map(|place| all[*place].clone())
        .collect();
    let units = units(arguments, &rows)?;
    let scales = scales(arguments, units, &chosen, model)?;
    let scaled = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let own = order.places.iter().zip(&scales);
        let own = own.filter_map(|(place, scale)| Some((columns.get(*place)?, scale)));
        own.map(|(column, (factor, zero))| column.iter().map(|own| own * factor + zero).collect())
            .collect()
    };
    let joints = chosen.len();
    let command = scaled(&rows.action).into_iter().enumerate();
    let count = rows.time_s.len();
    let mut warnings = Vec::new();
    if rows.action.is_empty() {
        warnings.push(format!(
            "the data set has no commands of these joints, and the log has none; its keys are {}: give --action",
            rows.known.join(", ")
        ));
    }
    let recording = Recording {
        line: (2..count as u64 + 2).collect(),
        joint: scaled(&rows.state),
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        covariates: command
            .map(|(joint, column)| (format!("command{}_rad", joint + 1), column))
            .collect(),
        time_s: Some(rows.time_s),
        run: Some(rows.episode),
        ..Recording::default()
    };
    let mut shape = shape_without_limits(&vec![false; joints], 0);
    for (joint, name) in shape.joints.iter_mut().zip(&chosen) {
        joint.name.clone_from(name);
    }
    warnings.extend(device.into_iter().flat_map(|device| device.warnings));
    warnings.extend(order.warning);
    let listed = chosen.iter().enumerate();
    let listed: Vec<String> = listed
        .map(|(joint, name)| format!("theta{} is {name}", joint + 1))
        .collect();
    let listed = listed.join(", ");
    warnings.push(format!("the joints by their columns: {listed}"));
    if keys.state != keys::LEROBOT_STATE {
        warnings.push(format!(
            "the joints are those of `{}`; give --state if that is wrong",
            keys.state
        ));
    }
    let imported = Imported::of(&recording, &shape, warnings)?;
    arguments.target.write(imported)
}

/// The rows of a data set, its joints' names, and the rows that its description says each episode has.
pub(crate) struct NamedRows {
    pub(crate) rows: Rows,
    pub(crate) names: Vec<String>,
    /// By the episode's number; empty where the data set does not say.
    pub(crate) lengths: BTreeMap<i64, usize>,
}

/// Reads a data set.
pub(crate) fn read_rows(dataset: &Path, keys: [Option<&str>; 2]) -> Result<NamedRows, Failure> {
    let info = info(dataset)?;
    let rows = Rows::read(dataset, keys, frames_per_second(info.as_ref()))?;
    let names = names(info.as_ref(), &rows.keys.state, rows.state.len());
    Ok(NamedRows {
        rows,
        names,
        lengths: lengths(dataset),
    })
}

/// Rows of each episode by meta/episodes.jsonl (version 2) or the Parquet files of meta/episodes (version 3).
fn lengths(dataset: &Path) -> BTreeMap<i64, usize> {
    let listed = std::fs::read_to_string(dataset.join("meta/episodes.jsonl")).unwrap_or_default();
    let lines = listed.lines().filter_map(|line| {
        let line: Value = serde_json::from_str(line).ok()?;
        let length = usize::try_from(line.get("length")?.as_u64()?).ok()?;
        Some((line.get("episode_index")?.as_i64()?, length))
    });
    let mut all: BTreeMap<i64, usize> = lines.collect();
    let tables = rows::parquet_files(&dataset.join("meta/episodes")).unwrap_or_default();
    for table in tables {
        let Ok(read) = read_parquet_columns(&table, &[], &["episode_index", "length"]) else {
            continue;
        };
        if let [Some(numbers), Some(lengths)] = &read.numbers[..] {
            let pairs = numbers.iter().zip(lengths);
            all.extend(pairs.map(|(number, length)| (*number as i64, *length as usize)));
        }
    }
    all
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

/// Rows in a second, of data sets without a time of each.
fn frames_per_second(info: Option<&Value>) -> Option<f64> {
    info?.get("fps")?.as_f64().filter(|fps| *fps > 0.0)
}

/// Names of the joints: those of the feature's list, else numbers.
fn names(info: Option<&Value>, state: &str, joints: usize) -> Vec<String> {
    let feature = info.and_then(|info| info.get("features")?.get(state));
    let names = feature.and_then(|feature| feature.get("names"));
    let listed = match names {
        Some(Value::Array(names)) => Some(names),
        // older ones have the list below the kind of the names
        Some(Value::Object(kinds)) => kinds.values().find_map(Value::as_array),
        _ => None,
    };
    // some have a list of lists
    let all = listed.into_iter().flatten().flat_map(|entry| match entry {
        Value::Array(names) => names.iter().collect(),
        name => vec![name],
    });
    let own: Vec<String> = all
        .filter_map(|name| Some(name.as_str()?.trim_end_matches(".pos").to_owned()))
        .collect();
    match own.len() == joints {
        true => own,
        false => (1..=joints).map(|joint| joint.to_string()).collect(),
    }
}

fn units(arguments: &LerobotArguments, rows: &Rows) -> Result<Units, Failure> {
    if let Some(units) = arguments.units {
        return Ok(units);
    }
    let largest = rows.largest();
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
        let said = format!(
            "percent are of a joint's range, and --joints lists {} where the device has {}; list as many",
            names.len(),
            device.joints.len()
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::names;

    #[test]
    fn names_are_found_in_each_form_that_recorders_write() {
        let forms = [
            json!(["a.pos", "b.pos"]),
            json!([["a", "b"]]),
            json!({"motors": ["a", "b"]}),
        ];
        for form in forms {
            let info = json!({"features": {"observation.state": {"names": form}}});
            assert_eq!(names(Some(&info), "observation.state", 2), ["a", "b"]);
            // names of other things are none
            assert_eq!(names(Some(&info), "observation.state", 3), ["1", "2", "3"]);
        }
    }
}
