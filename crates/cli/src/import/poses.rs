//! Any table to a log by flags: a mapping file in few words.

use std::path::PathBuf;

use clap::Args;
use haptical_tables::{ColumnRule, Mapping, OneOrMany, Reading, TEXTS, apply, read_table};

use super::Target;
use super::renamed::{Renaming, Scaling, factor, fault, renaming, scaling};
use super::table::{imported, is_covariate, joints_and_cables, refused};
use crate::failure::Failure;

/// End of the help of `haptical import poses`.
pub(super) const HELP: &str = "\
Example:
  haptical import poses table.csv --map theta1_rad=q1,theta2_rad=q2 --map x_m=px,y_m=py,z_m=pz \\
    --scale theta*=deg,x_m=mm,y_m=mm,z_m=mm --out log.csv

Names on the left are columns of a log (t_s, run, theta1_rad, out1_rad, cable_m, x_m, qw, hand, contact, plane,
tool, torque1_nm, fx_n, temp_degc, ...), names on the right columns of the table; #3 is its third column.
For several files, rotations, units and rows to match: `haptical import --guess FILE...`.";

/// Flags of `haptical import poses`.
#[derive(Debug, Args)]
pub(super) struct PosesArguments {
    /// Table, in any format that `haptical import --guess` reads
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

/// Runs the command.
pub(super) fn run(arguments: &PosesArguments) -> Result<(), Failure> {
    arguments.target.check(None)?;
    if let Some(what) = fault(&arguments.map, &arguments.scale) {
        let next = "name each column of the log once in --map";
        return Err(Failure::command_line("arguments", what, next));
    }
    let names = arguments.map.iter().map(|own| own.target.as_str());
    let names: Vec<&str> = names.collect();
    let (slides, cables) = joints_and_cables(&names);
    if slides.is_empty() {
        let said = "--map names no theta1_rad (or theta1_m), the first joint's readings; name a column for each joint, as \
                    theta1_rad=q1";
        return Err(Failure::arguments(said));
    }
    // a target that no log has is a mistyped one
    let is_mistyped = |name: &&&str| is_covariate(name, &slides, cables);
    if let Some(name) = names.iter().find(is_mistyped) {
        let what = format!(
            "--map names `{name}`, which is no column of a log, or of a joint that is not mapped"
        );
        let next = "see the names in `haptical import poses --help`";
        return Err(Failure::command_line("arguments", what, next));
    }
    let mapping = Mapping {
        table: Reading {
            header: Some(!arguments.no_header),
            ..Reading::default()
        },
        column: (arguments.map.iter())
            .map(|own| rule(own, &arguments.scale))
            .collect(),
        ..Mapping::default()
    };
    let table = read_table(&arguments.table, &mapping.table).map_err(refused)?;
    let log = apply(&[table], &mapping).map_err(refused)?;
    let imported = imported(log, None, &arguments.table)?;
    arguments.target.write(imported)
}

fn rule(own: &Renaming, scalings: &[Scaling]) -> ColumnRule {
    let is_text = TEXTS.contains(&own.target.as_str());
    ColumnRule {
        log: OneOrMany::One(own.target.clone()),
        from: OneOrMany::One(own.source.clone()),
        factor: factor(scalings, &own.target).filter(|_| !is_text),
        ..ColumnRule::default()
    }
}
