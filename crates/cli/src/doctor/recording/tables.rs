//! A table of any maker as a log: which columns are which is guessed from their names, as `haptical import --guess` does.

use std::path::Path;

use haptical_tables::{Cells, Mapping, Reading, apply, guess, read_table};

use super::logs::Log;
use crate::failure::Failure;
use crate::import::refused;

pub(super) fn read(file: &Path) -> Result<Log, Failure> {
    let tables = [read_table(file, &Reading::default()).map_err(refused)?];
    let proposal = guess(&tables, &[]);
    let mapping = Mapping::from_toml(&proposal, "the guess").map_err(refused)?;
    let named: Vec<&str> = mapping
        .column
        .iter()
        .flat_map(|rule| rule.log.names())
        .map(String::as_str)
        .collect();
    let unclear = |what: &str| {
        let next = "`haptical import --guess FILE` says which columns are which; correct it, import the files, then give the logs";
        Failure::in_file("no-log", what.to_owned(), file, next)
    };
    if !named.iter().any(|name| name.starts_with("theta")) {
        return Err(unclear("no column is known as a joint's position"));
    }
    let applied = apply(&tables, &mapping).map_err(refused)?;
    let rows = applied.columns.first().map_or(0, |(_, cells)| cells.len());
    let numbers = |wanted: &str| {
        let column = applied.columns.iter().find(|(name, _)| name == wanted);
        column.and_then(|(_, cells)| match cells {
            Cells::Numbers(numbers) => Some(numbers.clone()),
            Cells::Texts(_) => None,
        })
    };
    let of_joint = |kind: &str, joint: usize| {
        let ends = ["_rad", "_m"].into_iter();
        let mut found = ends.filter_map(|end| numbers(&format!("{kind}{joint}{end}")));
        found.next()
    };
    let position: Vec<Vec<f64>> = (1..).map_while(|joint| of_joint("theta", joint)).collect();
    let command: Vec<Vec<f64>> = (1..=position.len())
        .map_while(|joint| of_joint("command", joint))
        .collect();
    let time_s = numbers("t_s").ok_or_else(|| unclear("no column is known as the time"))?;
    let mut warnings = applied.warnings;
    if !command.is_empty() && command.len() != position.len() {
        warnings.push(format!(
            "{} joints and {} commands: the commands are not used",
            position.len(),
            command.len()
        ));
    }
    Ok(Log {
        names: (1..=position.len())
            .map(|joint| joint.to_string())
            .collect(),
        command: if command.len() == position.len() {
            command
        } else {
            Vec::new()
        },
        position,
        run: numbers("run").map(|runs| runs.iter().map(|run| *run as i64).collect()),
        time_s: if time_s.len() == rows {
            time_s
        } else {
            return Err(unclear("its columns are of different lengths"));
        },
        warnings,
    })
}
