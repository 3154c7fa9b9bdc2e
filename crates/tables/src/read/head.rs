//! Which of the first lines are names and units, and where the readings begin.

use std::collections::BTreeSet;

use super::grid::{Grid, Row, list};
use super::number::{is_missing, is_number, is_unit};
use super::{clock, motive};
use crate::error::TableError;
use crate::mapping::Reading;

/// Rows that are looked at below the first that may be one of readings.
const ROWS: usize = 20;
/// Lines of texts alone within so many rows below numbers are names still: numbers above them count the columns.
const LINES: usize = 3;

/// Names and units, and how many rows they take.
#[derive(Default)]
pub(super) struct Head {
    pub(super) names: Option<Vec<String>>,
    pub(super) units: Option<Vec<String>>,
    pub(super) rows: usize,
    /// Rows that are neither.
    pub(super) preamble: usize,
    /// What is known of the format.
    pub(super) note: Option<String>,
    /// Order of Euler angles.
    pub(super) euler: Option<String>,
}

/// Whether a cell is a reading.
fn is_reading(cell: &str) -> bool {
    is_number(cell) || clock::seconds(cell).is_some() || list(cell).is_some()
}

/// Whether a row is one of readings: half of its filled cells are numbers, times or lists of numbers, or each says that it has none.
fn is_data(row: &Row) -> bool {
    let filled = row.cells.iter().filter(|cell| !is_missing(cell));
    let readings = filled.clone().filter(|cell| is_reading(cell)).count();
    let filled = filled.count();
    let says_none = filled == 0 && row.cells.iter().all(|cell| !cell.is_empty());
    says_none || (readings > 0 && 2 * readings >= filled)
}

/// The first row of readings among those with this many cells; none where there are texts alone.
fn first_row(rows: &[Row], width: usize) -> Option<usize> {
    let is_whole = |row: &&Row| row.cells.len() == width;
    let first = rows.iter().position(|row| is_whole(&row) && is_data(row))?;
    let has_names = rows[..first].iter().any(|row| is_whole(&row));
    let below: Vec<&Row> = rows[first + 1..]
        .iter()
        .filter(is_whole)
        .take(ROWS)
        .collect();
    if !has_names && (names_numbers(&rows[first], &below) || counts(&rows[first], &below)) {
        return Some(first + 1);
    }
    let mut readings = rows[first].cells.iter().filter(|cell| is_reading(cell));
    if readings.all(|cell| cell.parse::<i64>().is_ok()) {
        let behind = rows[first + 1..].iter().take(LINES).rposition(says_texts);
        return Some(behind.map_or(first, |row| first + row + 2));
    }
    Some(first)
}

/// Whether several cells of a row are texts, and none is a reading.
fn says_texts(row: &Row) -> bool {
    let mut filled = row.cells.iter().filter(|cell| !is_missing(cell));
    filled.clone().count() > 1 && !filled.any(|cell| is_reading(cell))
}

/// Whether a row has a text where all rows below have numbers: `0,1,2,x,y,z` are names.
fn names_numbers(row: &Row, below: &[&Row]) -> bool {
    let mut cells = row.cells.iter().enumerate();
    cells.any(|(column, cell)| {
        let is_text = !is_missing(cell) && !is_reading(cell) && cell.parse::<f64>().is_err();
        is_text && !below.is_empty() && below.iter().all(|row| is_number(&row.cells[column]))
    })
}

/// Whether a row counts its columns from 0 or 1, and the rows below have other numbers: what writers without names put there.
fn counts(row: &Row, below: &[&Row]) -> bool {
    let numbers = row.cells.iter().skip_while(|cell| cell.is_empty());
    let numbers: Vec<Option<usize>> = numbers.map(|cell| cell.parse().ok()).collect();
    let first = numbers.first().copied().flatten();
    let in_order =
        (numbers.iter().zip(first.unwrap_or(0)..)).all(|(entry, wanted)| *entry == Some(wanted));
    let has_fractions = |row: &&Row| row.cells.iter().any(|cell| cell.contains(['.', ',']));
    numbers.len() > 2
        && first.is_some_and(|first| first < 2)
        && in_order
        && !below.is_empty()
        && below.iter().all(has_fractions)
}

pub(super) fn head(
    grid: &Grid,
    width: usize,
    reading: &Reading,
    name: &str,
) -> Result<Head, TableError> {
    let comment = || {
        let names = grid.comment.clone()?;
        (names.len() == width && !names.iter().any(|entry| is_number(entry))).then_some(names)
    };
    if reading.header == Some(false) {
        return Ok(Head::default());
    }
    let first = match (reading.header, first_row(&grid.rows, width)) {
        // texts alone: the first line has the names
        (_, None) => 1,
        (Some(true), Some(0)) => 1,
        (_, Some(first)) => first,
    };
    let above = &grid.rows[..first];
    let whole: Vec<usize> = (0..above.len())
        .filter(|&row| above[row].cells.len() == width)
        .collect();
    let says_units = |row: usize| {
        let cells = &above[row].cells;
        let filled = cells.iter().filter(|cell| !cell.is_empty());
        filled.clone().count() > 0 && filled.clone().all(|cell| is_unit(cell).is_some())
    };
    let last = whole.last().copied();
    let units = match (reading.units_row, last) {
        (Some(false), _) | (_, None) => None,
        (Some(true), last) => last,
        (None, Some(last)) => (whole.len() > 1 && says_units(last)).then_some(last),
    };
    if reading.units_row == Some(true) && units.is_none() {
        let what = "there is no line of units above the rows";
        return Err(TableError::new(
            "no-units",
            what,
            name,
            "delete units_row from [table]",
        ));
    }
    let names = whole.iter().rev().find(|&&row| Some(row) != units).copied();
    let (text, joined) = match names {
        Some(row) => {
            let (names, joined) = joined(&above[..=row], width);
            (Some(names), joined)
        }
        None => (comment(), 0),
    };
    let text_units = units.map(|row| above[row].cells.clone());
    let facts = motive::facts(above, names, width);
    let found = Head {
        names: text,
        rows: first,
        preamble: match &facts.note {
            Some(_) => 0,
            None => first.saturating_sub(joined + usize::from(units.is_some())),
        },
        units: text_units.or(facts.units),
        note: facts.note,
        euler: facts.euler,
    };
    if found.names.is_none() && reading.header == Some(true) {
        let what = "there is no line of names above the rows";
        return Err(TableError::new(
            "no-header",
            what,
            name,
            "say `header = false` in [table]",
        ));
    }
    Ok(found)
}

/// The names of the last of these rows, and how many rows they take. Where they are not unique, what stands above them comes before
/// them: `X` below `Position` below `Tool` is `Tool.Position.X`.
fn joined(above: &[Row], width: usize) -> (Vec<String>, usize) {
    let Some((last, further)) = above.split_last() else {
        return (Vec::new(), 0);
    };
    let mut names = last.cells.clone();
    let mut used = 1;
    for row in further.iter().rev() {
        let repeated = repeated(&names);
        if repeated == 0 {
            break;
        }
        // a preamble, or numbers of columns
        let mut filled = row.cells.iter().filter(|cell| !cell.is_empty());
        let is_name = row.cells.len() <= width && filled.any(|cell| !is_reading(cell));
        if !is_name || motive::is_left_out(row) {
            continue;
        }
        let longer = below(row, &names);
        if self::repeated(&longer) < repeated {
            names = longer;
            used += 1;
        }
    }
    (names, used)
}

/// How many names are there already.
fn repeated(names: &[String]) -> usize {
    let filled = || names.iter().filter(|entry| !entry.is_empty());
    filled().count() - filled().collect::<BTreeSet<_>>().len()
}

/// Names with the cells of a row before them; a cell over several columns stands above the first of them.
fn below(row: &Row, names: &[String]) -> Vec<String> {
    let mut cell = "";
    let names = names.iter().enumerate();
    names
        .map(|(column, entry)| {
            cell = match row.cells.get(column) {
                Some(here) if !here.is_empty() && !motive::is_label(here, column) => here,
                _ => cell,
            };
            match (cell.is_empty(), entry.is_empty()) {
                (true, _) => entry.clone(),
                (false, true) => cell.to_owned(),
                (false, false) => format!("{cell}.{entry}"),
            }
        })
        .collect()
}
