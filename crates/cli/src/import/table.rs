//! Tables of any maker to a log by a mapping file, `columns.toml`, which `--guess` proposes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use haptical_data::{Cells, LogShape, log_from_columns};
use haptical_model::Recording;
use haptical_tables::{
    Applied, Mapping, Reading, TEXTS, Table, TableError, apply, guess, read_table,
};

use super::{Imported, Target, shape_without_limits};
use crate::failure::Failure;
use crate::flags::DeviceOptions;
use crate::terminal;

/// Flags of `haptical import` without an origin.
#[derive(Debug, Args)]
pub(super) struct TableArguments {
    /// Tables: text, .xlsx, .npy, .npz, .mat, JSON lines; each is a run, or several side by side are, as the mapping file says
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Propose a mapping file for these files: on standard output, or at --out
    #[arg(long, conflicts_with = "columns")]
    guess: bool,
    /// Mapping file: which columns are which of a log, in what units
    #[arg(long, value_name = "COLUMNS.TOML")]
    columns: Option<PathBuf>,
    /// Log to write (CSV), with --guess mapping file to write (TOML); its folder is made if it is missing
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Device file (TOML, URDF or MJCF): joints are found by its names, the log is checked against its limits
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    #[command(flatten)]
    device_options: DeviceOptions,
    /// Overwrite files at --out with other content; a log does not say who wrote it
    #[arg(long)]
    force: bool,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(super) fn run(arguments: &TableArguments) -> Result<(), Failure> {
    if arguments.files.is_empty() {
        let said = "no files to import; haptical import --guess FILE... > columns.toml; see `haptical import --help` for other \
                    origins";
        return Err(Failure::arguments(said));
    }
    if arguments.guess {
        return propose(arguments);
    }
    let Some(columns) = &arguments.columns else {
        let said = "it is not said which columns of the files are which of a log; give --columns columns.toml, which \
                    `haptical import --guess FILE...` proposes";
        return Err(Failure::arguments(said));
    };
    let Some(out) = &arguments.out else {
        let said = "no place for the log; give --out log.csv";
        return Err(Failure::arguments(said));
    };
    let target = target(arguments, out);
    target.check(None)?;
    let text = std::fs::read_to_string(columns).map_err(|error| {
        let next = "`haptical import --guess FILE...` writes one";
        Failure::unreadable(&error, columns, next)
    })?;
    let mapping = Mapping::from_toml(&text, &columns.display().to_string()).map_err(refused)?;
    let tables = tables(arguments, &mapping.table)?;
    let shape = shape_of_device(arguments)?;
    let log = apply(&tables, &mapping).map_err(refused)?;
    target.write(imported(log, shape, &arguments.files[0])?)
}

fn tables(arguments: &TableArguments, reading: &Reading) -> Result<Vec<Table>, Failure> {
    let tables = arguments.files.iter();
    let tables = tables.map(|file| read_table(file, reading).map_err(refused));
    tables.collect()
}

/// Prints or writes a mapping file.
fn propose(arguments: &TableArguments) -> Result<(), Failure> {
    if let Some(out) = &arguments.out {
        let rule = target(arguments, out).rule();
        rule.check_inputs(std::slice::from_ref(out))?;
    }
    let tables = tables(arguments, &Reading::default())?;
    let joints = shape_of_device(arguments)?.map_or_else(Vec::new, |shape| shape.joints);
    let joints = joints.into_iter();
    let joints: Vec<_> = joints.map(|own| (own.name, own.prismatic)).collect();
    let text = guess(&tables, &joints);
    let Some(out) = &arguments.out else {
        let value = serde_json::json!({ "mapping": text });
        return terminal::tell(arguments.json, &value, text);
    };
    target(arguments, out).write_text(text)
}

fn target(arguments: &TableArguments, out: &Path) -> Target {
    Target {
        out: out.to_owned(),
        force: arguments.force,
        json: arguments.json,
    }
}

fn shape_of_device(arguments: &TableArguments) -> Result<Option<LogShape>, Failure> {
    let device = arguments.device.as_deref();
    let device = device.map(|path| arguments.device_options.read_by_path(path));
    Ok(device
        .transpose()?
        .map(|device| LogShape::from(&device.model)))
}

/// A refusal of the tables' crate as one of the command.
pub(crate) fn refused(error: TableError) -> Failure {
    let file = Path::new(&error.file);
    let TableError {
        kind, what, next, ..
    } = error;
    match error.line {
        Some(line) => Failure::placed(kind, what, file, (line, error.column.unwrap_or(0)), next),
        None => Failure::in_file(kind, what, file, next),
    }
}

/// Columns as a log, checked as every log is. Without a device the joints are those that the columns name.
pub(super) fn imported(
    applied: Applied,
    shape: Option<LogShape>,
    file: &Path,
) -> Result<Imported, Failure> {
    let names = applied.columns.iter().map(|(name, _)| name.as_str());
    let names: Vec<&str> = names.collect();
    let shape = match shape {
        Some(shape) => shape,
        None => named_shape(&applied, &names)?,
    };
    let runs = applied.columns.iter().find(|(name, _)| name == "run");
    let runs: Vec<i64> = match runs {
        Some((_, haptical_tables::Cells::Numbers(runs))) => {
            runs.iter().map(|run| *run as i64).collect()
        }
        _ => Vec::new(),
    };
    let columns = applied.columns.iter().map(|(name, cells)| {
        let cells = match cells {
            haptical_tables::Cells::Numbers(_) if name == "run" => Cells::Integers(&runs),
            haptical_tables::Cells::Numbers(numbers) => Cells::Numbers(numbers),
            haptical_tables::Cells::Texts(texts) => Cells::Texts(texts),
        };
        (name.as_str(), cells)
    });
    let columns: Vec<(&str, Cells<'_>)> = columns.collect();
    // its lines are the log's
    let name = format!("{}, as a log", file.display());
    let read = log_from_columns(&columns, &name, &shape)?;
    let mut warnings = applied.warnings;
    warnings.extend(read.warnings);
    warnings.extend(of_joints_alone(&read.recording));
    Imported::of(&read.recording, &shape, warnings)
}

/// A log that nothing can be calibrated with.
fn of_joints_alone(recording: &Recording) -> Option<String> {
    let has = |columns: &[Option<Vec<f64>>]| columns.iter().any(Option::is_some);
    let has_own = recording.position_m.is_some()
        || recording.orientation_wxyz.is_some()
        || recording.contact.is_some()
        || recording.plane.is_some();
    let has_any = has_own
        || has(&recording.output)
        || has(&recording.cable_m)
        || has(&recording.torque_nm)
        || (recording.covariates.iter()).any(|(name, _)| name.starts_with("command"));
    (!has_any).then(|| {
        "the log has the joints and nothing that was measured besides, so that nothing can be calibrated with it: is a column left \
         out in the mapping file?"
            .to_owned()
    })
}

/// The shape that the columns' own names have.
fn named_shape(applied: &Applied, names: &[&str]) -> Result<LogShape, Failure> {
    let (slides, cables) = joints_and_cables(names);
    if slides.is_empty() {
        let said = "no column is theta1_rad (or theta1_m), the first joint's readings; name a column for each joint, as \
                    log = \"theta1_rad\" in the mapping file";
        return Err(Failure::arguments(said));
    }
    let mut shape = shape_without_limits(&slides, cables);
    let hand = applied.columns.iter().find(|(name, _)| name == "hand");
    if let Some((_, haptical_tables::Cells::Texts(hands))) = hand {
        let hands: BTreeSet<&String> = hands.iter().filter(|hand| !hand.is_empty()).collect();
        // whatever a table has, the device file will declare
        shape.hands = hands.into_iter().cloned().collect();
    }
    Ok(shape)
}

/// The joints that slide, by the names `theta1_rad`, `theta2_m`, ... up to the first that is missing; and the number of cables.
pub(super) fn joints_and_cables(names: &[&str]) -> (Vec<bool>, usize) {
    let has = |name: String| names.contains(&name.as_str());
    let mut slides = Vec::new();
    loop {
        let number = slides.len() + 1;
        let turns = has(format!("theta{number}_rad"));
        if !turns && !has(format!("theta{number}_m")) {
            break;
        }
        slides.push(!turns);
    }
    let cables = names.iter().filter(|name| {
        let number = name.strip_prefix("cable");
        let number = number.and_then(|rest| rest.strip_suffix("_m"));
        number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
    });
    (slides, cables.count())
}

/// Columns of the log that no log has by this name, or of joints that have no readings: covariates, if they are meant so.
pub(super) fn is_covariate(name: &str, slides: &[bool], cables: usize) -> bool {
    const PLAIN: &str = "t_s run temp_degc x_m y_m z_m qw qx qy qz fx_n fy_n fz_n";
    if PLAIN.split(' ').any(|own| own == name) || TEXTS.contains(&name) {
        return false;
    }
    if name == "cable_m" || (2..=cables).any(|cable| name == format!("cable{cable}_m")) {
        return false;
    }
    !slides.iter().enumerate().any(|(joint, slides)| {
        let (joint, unit) = (joint + 1, if *slides { "m" } else { "rad" });
        let of_joint = [
            format!("theta{joint}_{unit}"),
            format!("out{joint}_{unit}"),
            format!("torque{joint}_nm"),
        ];
        of_joint.iter().any(|own| own == name) || (*slides && name == format!("torque{joint}_n"))
    })
}
