//! Tables to the columns of a log, as a mapping says.

mod cells;
mod matched;
mod turned;

use haptical_data::{MOST_COLUMNS, MOST_MEMORY_BYTES};

use self::cells::{integer_of, number_of, text_of};
use self::matched::Matched;
use crate::error::TableError;
use crate::guess::units::stated;
use crate::mapping::{ColumnRule, Mapping, Scalar, TEXTS, Value, dimension_of};
use crate::table::{Cells, Table};

/// Columns of a log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Applied {
    /// Names and cells, in the order of the mapping; `run` holds whole numbers.
    pub columns: Vec<(String, Cells)>,
    /// What a person should know.
    pub warnings: Vec<String>,
}

/// A column of a table: its place among the files side by side, and in the file.
type Source = (usize, usize);

/// Makes the columns of a log from tables, in the order of the files.
///
/// Each `files_per_run` of them are a run, their rows matched as the mapping says.
///
/// # Errors
/// A column that is not there or is no number, rows that do not match, a matrix that is no rotation.
pub fn apply(tables: &[Table], mapping: &Mapping) -> Result<Applied, TableError> {
    let files = mapping.rows.files_per_run.unwrap_or(1);
    let first = tables
        .first()
        .map_or("the files", |table| table.file.as_str());
    if tables.is_empty() || !tables.len().is_multiple_of(files) {
        let what = format!("{} files, and files_per_run is {files}", tables.len());
        let next = "give the files of one run next to each other, the same number for each run";
        return Err(TableError::new("file-count", what, first, next));
    }
    let mut log = Applied::default();
    let mut rows = 0;
    for (index, run) in tables.chunks(files).enumerate() {
        let own = of_run(run, mapping, index, &mut log.warnings)?;
        rows += own.first().map_or(0, |(_, cells)| cells.len());
        if (rows * own.len().max(1)) as u64 * 24 > MOST_MEMORY_BYTES || own.len() > MOST_COLUMNS {
            return Err(TableError::too_large(first));
        }
        match log.columns.is_empty() {
            true => log.columns = own,
            false => {
                for ((_, all), (_, more)) in log.columns.iter_mut().zip(own) {
                    extend(all, more);
                }
            }
        }
    }
    for table in tables {
        log.warnings.splice(0..0, table.notes.iter().cloned());
    }
    let has_run = log.columns.iter().any(|(name, _)| name == "run");
    if tables.len() > files && !has_run {
        let lengths = run_lengths(tables, mapping)?;
        let numbers = (1..)
            .zip(lengths)
            .flat_map(|(run, rows)| vec![f64::from(run); rows]);
        log.columns
            .insert(0, ("run".to_owned(), Cells::Numbers(numbers.collect())));
    }
    Ok(log)
}

fn extend(all: &mut Cells, more: Cells) {
    match (all, more) {
        (Cells::Numbers(all), Cells::Numbers(more)) => all.extend(more),
        (Cells::Texts(all), Cells::Texts(more)) => all.extend(more),
        // the same rule makes the same kind of cells in each run
        _ => {}
    }
}

/// Rows of each run.
fn run_lengths(tables: &[Table], mapping: &Mapping) -> Result<Vec<usize>, TableError> {
    let files = mapping.rows.files_per_run.unwrap_or(1);
    let lengths = tables
        .chunks(files)
        .map(|run| Ok(matched::rows(run, mapping)?.rows.len()));
    lengths.collect()
}

/// The columns of one run.
fn of_run(
    run: &[Table],
    mapping: &Mapping,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<Vec<(String, Cells)>, TableError> {
    let matched = matched::rows(run, mapping)?;
    warnings.extend(matched.warnings.iter().cloned());
    let mut columns = Vec::new();
    if let Some(rate_hz) = mapping.rows.rate_hz {
        let time = matched.rows.iter().map(|row| *row as f64 / rate_hz);
        columns.push(("t_s".to_owned(), Cells::Numbers(time.collect())));
    }
    for rule in &mapping.column {
        for (place, log) in rule.log.names().iter().enumerate() {
            let cells = match rule.from.names().get(place) {
                Some(from) => from_file(run, &matched, rule, (log, from), warnings)?,
                None => given(run, rule, log, index, &matched)?,
            };
            columns.push((log.clone(), cells));
        }
    }
    if let Some(orientation) = &mapping.orientation {
        turned::add(run, orientation, &matched, &mut columns)?;
    }
    Ok(columns)
}

/// The place of a column among the files of a run.
fn source(run: &[Table], file: Option<usize>, from: &str) -> Result<Source, TableError> {
    let own = |place: usize| {
        run.get(place)
            .map(|table| table.find(from).map(|column| (place, column)))
    };
    if let Some(file) = file {
        return own(file.wrapping_sub(1)).unwrap_or_else(|| {
            let what = format!(
                "column `{from}` is of file {file}, and a run has {}",
                run.len()
            );
            let next = "count the files side by side from 1, as files_per_run says";
            Err(TableError::new("file-count", what, &run[0].file, next))
        });
    }
    let mut found: Vec<Source> = (0..run.len())
        .filter_map(|place| own(place)?.ok())
        .collect();
    match (found.pop(), found.pop()) {
        (Some(only), None) => Ok(only),
        (Some(_), Some(_)) => {
            let what = format!("column `{from}` is in several of the files");
            let next = "say which with `file = 1` in its [[column]]";
            Err(TableError::new("missing-column", what, &run[0].file, next))
        }
        (None, _) => match run {
            [only] => only.find(from).map(|column| (0, column)),
            _ => {
                let what = format!("no file has a column `{from}`");
                let has = run
                    .iter()
                    .map(|table| format!("{}: {}", table.file, table.names()));
                let next = format!("they have: {}", has.collect::<Vec<String>>().join("; "));
                Err(TableError::new("missing-column", what, &run[0].file, next))
            }
        },
    }
}

/// Cells of a column of a file, row by row of the log.
fn from_file(
    run: &[Table],
    matched: &Matched,
    rule: &ColumnRule,
    (log, from): (&str, &str),
    warnings: &mut Vec<String>,
) -> Result<Cells, TableError> {
    let (file, column) = source(run, rule.file, from)?;
    let table = &run[file];
    if TEXTS.contains(&log) {
        let texts = matched
            .of(file)
            .map(|row| row.map_or_else(String::new, |row| text_of(table, column, row)));
        return Ok(Cells::Texts(texts.collect()));
    }
    let bad = |what| TableError::new("bad-mapping", what, &table.file, "correct the mapping file");
    let (mut factor, mut zero) = rule.scale(log).map_err(bad)?;
    let said = stated(&table.columns[column]);
    if let Some((word, unit)) = said.filter(|(_, unit)| Some(unit.dimension) == dimension_of(log)) {
        if rule.is_silent_on_units() {
            (factor, zero) = (unit.factor, unit.zero);
        } else if rule.unit.is_some() && (unit.factor, unit.zero) != (factor, zero) {
            let own = rule.unit.as_deref().unwrap_or_default();
            warnings.push(format!(
                "{}: column `{from}` says {word}, and the mapping file {own}: {own} was taken",
                table.file
            ));
        }
    }
    let plus = rule
        .plus
        .as_deref()
        .map(|plus| table.find(plus))
        .transpose()?;
    // its zero is in the sum once
    let added = |row: usize| -> Result<f64, TableError> {
        match plus {
            Some(column) => Ok(rule.plus_factor.unwrap_or(1.0) * number_of(table, column, row)?),
            None => Ok(0.0),
        }
    };
    let numbers = matched.of(file).map(|row| {
        let Some(row) = row else {
            return Ok(f64::NAN);
        };
        let mut number = number_of(table, column, row)?;
        if plus.is_some() {
            number += added(row)?;
        }
        match log {
            "run" => integer_of(table, column, row, number),
            // what is taken as it is keeps its digits
            _ if factor == 1.0 && zero == 0.0 => Ok(number),
            _ => Ok(factor * number + zero),
        }
    });
    Ok(Cells::Numbers(numbers.collect::<Result<_, _>>()?))
}

/// Cells that the mapping itself gives.
fn given(
    run: &[Table],
    rule: &ColumnRule,
    log: &str,
    index: usize,
    matched: &Matched,
) -> Result<Cells, TableError> {
    let refuse = |what: String| {
        Err(TableError::new(
            "bad-mapping",
            what,
            &run[0].file,
            "correct the mapping file",
        ))
    };
    let value = match (&rule.value, &rule.by_run) {
        (Some(value), _) => value,
        (None, Some(values)) => match values.get(index) {
            Some(value) => value,
            None => {
                return refuse(format!(
                    "`{log}` has {} values by_run, and this is run {}",
                    values.len(),
                    index + 1
                ));
            }
        },
        (None, None) => return refuse(format!("`{log}` has no cells")),
    };
    let in_turn = match value {
        Value::One(scalar) => std::slice::from_ref(scalar),
        Value::InTurn(scalars) => &scalars[..],
    };
    if in_turn.is_empty() {
        return refuse(format!("`{log}` has an empty list of values"));
    }
    let cells = matched.rows.iter().map(|row| &in_turn[row % in_turn.len()]);
    if TEXTS.contains(&log) {
        let text = |scalar: &Scalar| match scalar {
            Scalar::Text(text) => text.clone(),
            Scalar::Number(number) => number.to_string(),
        };
        return Ok(Cells::Texts(cells.map(text).collect()));
    }
    let numbers: Option<Vec<f64>> = cells
        .map(|scalar| match scalar {
            Scalar::Number(number) => Some(*number),
            Scalar::Text(_) => None,
        })
        .collect();
    match numbers {
        Some(numbers) => Ok(Cells::Numbers(numbers)),
        None => refuse(format!(
            "`{log}` is a number, and its value in the mapping file a text"
        )),
    }
}
