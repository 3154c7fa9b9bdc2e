//! Any CSV table to a log: its columns renamed and scaled, then read as every log is.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::PathBuf;

use clap::Args;
use csv::StringRecord;
use haptical_data::read_log_from;

use super::renamed::{Renaming, Scaling, factor, fault, joints_and_cables, renaming, scaling};
use super::{Imported, Target, shape_without_limits};
use crate::failure::Failure;

/// End of the help of `haptical import poses`.
pub(super) const HELP: &str = "\
Example:
  haptical import poses table.csv --map theta1_rad=q1,theta2_rad=q2 --map x_m=px,y_m=py,z_m=pz \\
    --scale theta*=deg,x_m=mm,y_m=mm,z_m=mm --out log.csv

Names on the left are columns of a log (t_s, run, theta1_rad, out1_rad, cable_m, x_m, qw, hand, contact, plane,
tool, torque1_nm, fx_n, temp_degc, ...), names on the right columns of the table; #3 is its third column.";

/// Flags of `haptical import poses`.
#[derive(Debug, Args)]
pub(super) struct PosesArguments {
    /// Table (CSV)
    #[arg(value_name = "FILE")]
    table: PathBuf,
    #[command(flatten)]
    target: Target,
    /// Columns of the log and the table's columns that they are, separated by commas
    #[arg(long, value_name = "NAME=SOURCE", required = true, value_delimiter = ',', value_parser = renaming)]
    map: Vec<Renaming>,
    /// Factors on columns of the log: a number, deg, mm, um, ms, us or ns; theta* means all that begin so
    #[arg(long, value_name = "NAME=FACTOR", value_delimiter = ',', value_parser = scaling)]
    scale: Vec<Scaling>,
    /// The table's first line has no names but numbers; name columns as #1, #2, ...
    #[arg(long)]
    no_header: bool,
}

/// Columns of which the cells are names.
const TEXTS: [&str; 4] = ["hand", "contact", "plane", "tool"];

/// Runs the command.
pub(super) fn run(arguments: &PosesArguments) -> Result<(), Failure> {
    arguments.target.check(None, &[&arguments.table])?;
    if let Some(what) = fault(&arguments.map, &arguments.scale) {
        let next = "name each column of the log once in --map";
        return Err(Failure::command_line("arguments", what, next));
    }
    let (slides, cables) = joints_and_cables(&arguments.map);
    if slides.is_empty() {
        return Err(Failure::command_line(
            "arguments",
            "--map names no theta1_rad (or theta1_m), the first joint's readings",
            "name a column for each joint, as theta1_rad=q1",
        ));
    }
    let log = translated(arguments)?;
    let mut shape = shape_without_limits(&slides, cables);
    shape.hands = hands(&log);
    // its lines are the table's, its columns are not
    let name = format!("{}, renamed", arguments.table.display());
    let read = read_log_from(&log[..], &name, &shape)?;
    refuse_covariates(arguments, &read.recording.covariates)?;
    arguments.target.write(Imported {
        log,
        rows: read.recording.len(),
        joints: slides.len(),
        beside: None,
        warnings: read.warnings,
    })
}

/// A target that no log has is a mistyped one.
fn refuse_covariates(
    arguments: &PosesArguments,
    covariates: &[(String, Vec<f64>)],
) -> Result<(), Failure> {
    let is_mapped = |name: &str| arguments.map.iter().any(|own| own.target == *name);
    match covariates.iter().find(|(name, _)| is_mapped(name)) {
        None => Ok(()),
        Some((name, _)) => Err(Failure::command_line(
            "arguments",
            format!(
                "--map names `{name}`, which is no column of a log, or of a joint that is not mapped"
            ),
            "see the names in `haptical import poses --help`",
        )),
    }
}

/// The log's text: the table's cells under their new names, line by line as in the table.
fn translated(arguments: &PosesArguments) -> Result<Vec<u8>, Failure> {
    let table = &arguments.table;
    let next = "give a table as CSV in UTF-8, separated by commas";
    let unreadable = |error: csv::Error| {
        Failure::in_file(
            "unreadable",
            format!("cannot be read: {error}"),
            table,
            next,
        )
    };
    let file = File::open(table).map_err(|error| Failure::unreadable(&error, table, next))?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(!arguments.no_header)
        .trim(csv::Trim::All)
        .from_reader(file);
    let header = reader.headers().map_err(unreadable)?.clone();
    let mut columns = Vec::new();
    for renaming in &arguments.map {
        columns.push((source(arguments, renaming, &header)?, renaming));
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = arguments.map.iter().map(|renaming| &renaming.target);
    writer.write_record(names).map_err(Failure::internal)?;
    let (mut record, mut cells) = (StringRecord::new(), Vec::new());
    while reader.read_record(&mut record).map_err(unreadable)? {
        let line = record.position().map_or(1, csv::Position::line);
        for &(index, renaming) in &columns {
            let cell = record.get(index).unwrap_or_default();
            let scaled = scaled(cell, renaming, &arguments.scale).map_err(|what| {
                let next = "correct it, or leave the cell empty where there is no reading";
                let place = (line, index as u64 + 1);
                Failure::placed("not-a-number", what, table, place, next)
            })?;
            cells.push(scaled.unwrap_or_else(|| cell.to_owned()));
        }
        writer
            .write_record(cells.drain(..))
            .map_err(Failure::internal)?;
    }
    writer.into_inner().map_err(Failure::internal)
}

/// Names in the column `hand`: whatever a table has, the device file will declare.
fn hands(log: &[u8]) -> Vec<String> {
    let mut rows = csv::Reader::from_reader(log);
    let headers = rows.headers().ok();
    let place = headers.and_then(|names| names.iter().position(|name| name == "hand"));
    let Some(place) = place else {
        return Vec::new();
    };
    let cells = rows.records().flatten();
    let names = cells.filter_map(|row| Some(row.get(place)?.trim().to_owned()));
    let names: BTreeSet<String> = names.filter(|name| !name.is_empty()).collect();
    names.into_iter().collect()
}

/// The scaled number; none where the cell stays as it is.
fn scaled(cell: &str, renaming: &Renaming, scalings: &[Scaling]) -> Result<Option<String>, String> {
    if cell.is_empty() || TEXTS.contains(&renaming.target.as_str()) {
        return Ok(None);
    }
    match (cell.parse::<f64>(), factor(scalings, &renaming.target)) {
        (Ok(number), _) if !number.is_finite() => Err(format!("`{cell}` is not a finite number")),
        (Ok(_), None) => Ok(None),
        (Ok(number), Some(factor)) => Ok(Some(format!("{:?}", number * factor))),
        (Err(_), _) => {
            let found: String = cell.chars().take(40).collect();
            Err(format!("expected a number, found `{found}`"))
        }
    }
}

/// The index of a source column.
fn source(
    arguments: &PosesArguments,
    renaming: &Renaming,
    header: &StringRecord,
) -> Result<usize, Failure> {
    let name = &renaming.source;
    let refuse = |what: String, next: String| {
        let table = &arguments.table;
        Err(Failure::in_file("missing-column", what, table, next))
    };
    let number = name.strip_prefix('#');
    if let Some(number) = number.and_then(|number| number.parse::<usize>().ok()) {
        return match number.checked_sub(1) {
            Some(index) if index < header.len() => Ok(index),
            _ => refuse(
                format!("there is no column {name}, the table has {}", header.len()),
                "columns are numbered from #1".to_owned(),
            ),
        };
    }
    if arguments.no_header {
        return refuse(
            format!("--no-header leaves no column the name `{name}`"),
            "name columns as #1, #2, ...".to_owned(),
        );
    }
    let mut found = header.iter().enumerate().filter(|(_, cell)| cell == name);
    match (found.next(), found.next()) {
        (Some((index, _)), None) => Ok(index),
        (Some((first, _)), Some((second, _))) => refuse(
            format!("two columns are called `{name}`"),
            format!("name one of them as #{} or #{}", first + 1, second + 1),
        ),
        (None, _) => {
            let names: Vec<&str> = header.iter().take(40).collect();
            refuse(
                format!("there is no column `{name}`"),
                format!("the table has: {}", names.join(", ")),
            )
        }
    }
}
