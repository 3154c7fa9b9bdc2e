//! Rows of cells to named columns: which lines are names and units, which columns are numbers, lists within cells.

use super::clock;
use super::dialect::usual;
use super::number::{is_missing, is_number, is_unit, number};
use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::{Cells, Column, Table};

/// A row of cells.
pub(super) struct Row {
    pub(super) line: u64,
    pub(super) cells: Vec<String>,
}

/// The rows of a text or a sheet.
pub(super) struct Grid {
    pub(super) rows: Vec<Row>,
    /// Words of a comment line above the rows.
    pub(super) comment: Option<Vec<String>>,
}

/// Names and units, and how many rows they take.
struct Head {
    names: Option<Vec<String>>,
    units: Option<Vec<String>>,
    rows: usize,
}

pub(super) fn to_table(
    grid: &Grid,
    decimal: char,
    name: &str,
    reading: &Reading,
) -> Result<Table, TableError> {
    let width = usual(grid.rows.iter().map(|row| row.cells.len()));
    if grid.rows.is_empty() || width == 0 {
        return Err(TableError::new(
            "no-rows",
            "the table has no rows",
            name,
            "give a table with rows",
        ));
    }
    let head = head(grid, width, reading, name)?;
    let mut notes = Vec::new();
    let above = head.rows - usize::from(head.units.is_some());
    let used = usize::from(head.names.is_some()).min(above);
    if above > used {
        notes.push(format!(
            "{name}: the first {} lines are taken for a preamble",
            above - used
        ));
    }
    let rows = &grid.rows[head.rows..];
    let uneven = rows.iter().find(|row| row.cells.len() != width);
    if let Some(row) = uneven {
        let what = format!("{} cells where most rows have {width}", row.cells.len());
        let next = "correct the row, or say separator, comment or skip_lines in [table] of the mapping file";
        return Err(TableError::new("cell-count", what, name, next).at(row.line, None));
    }
    let mut columns = Vec::new();
    for index in 0..width {
        let own = head.names.as_ref().and_then(|names| names.get(index));
        let own = own.filter(|own| !own.is_empty()).cloned();
        let own = own.unwrap_or_else(|| format!("#{}", index + 1));
        let unit = head.units.as_ref().and_then(|units| units.get(index));
        let unit = unit.and_then(|unit| is_unit(unit)).map(str::to_owned);
        let unit = unit.or_else(|| unit_in(&own));
        let cells = || rows.iter().map(|row| row.cells[index].as_str());
        push_column(&mut columns, own, unit, cells, decimal);
    }
    Ok(Table {
        file: name.to_owned(),
        columns,
        is_named: head.names.is_some(),
        lines: rows.iter().map(|row| row.line).collect(),
        notes,
        dialect: None,
    })
}

/// Adds a column: numbers if all its cells are, seconds if all are times of a clock, its elements if all are lists of the same length,
/// else texts.
fn push_column<'c, C: Iterator<Item = &'c str>>(
    columns: &mut Vec<Column>,
    name: String,
    unit: Option<String>,
    cells: impl Fn() -> C,
    decimal: char,
) {
    let numbers: Option<Vec<f64>> = cells()
        .map(|cell| match is_missing(cell) {
            true => Some(f64::NAN),
            false => number(cell, decimal).filter(|number| number.is_finite()),
        })
        .collect();
    if let Some(numbers) = numbers {
        columns.push(Column {
            name,
            unit,
            cells: Cells::Numbers(numbers),
        });
        return;
    }
    if let Some(seconds) = clock::column(cells()) {
        columns.push(Column {
            name,
            unit: Some("s".to_owned()),
            cells: Cells::Numbers(seconds),
        });
        return;
    }
    let lists: Option<Vec<Vec<f64>>> = cells().map(list).collect();
    let lists = lists.filter(|lists| {
        let width = lists.first().map_or(0, Vec::len);
        width > 0 && lists.iter().all(|list| list.len() == width)
    });
    let Some(lists) = lists else {
        let cells = cells().map(|cell| {
            if is_missing(cell) {
                String::new()
            } else {
                cell.to_owned()
            }
        });
        columns.push(Column {
            name,
            unit,
            cells: Cells::Texts(cells.collect()),
        });
        return;
    };
    for element in 0..lists[0].len() {
        let own = format!("{name}[{}]", element + 1);
        let numbers = lists.iter().map(|list| list[element]).collect();
        columns.push(Column {
            name: own,
            unit: unit.clone(),
            cells: Cells::Numbers(numbers),
        });
    }
}

/// The numbers of a list in a cell, `[1.0 2.0]` as NumPy prints it or `[1.0, 2.0]`; lists within lists row by row.
pub(super) fn list(cell: &str) -> Option<Vec<f64>> {
    let inner = cell.trim().strip_prefix('[')?.strip_suffix(']')?;
    let separates =
        |letter: char| letter.is_whitespace() || matches!(letter, ',' | ';' | '[' | ']');
    let words = inner.split(separates).filter(|word| !word.is_empty());
    words
        .map(|word| number(word, '.').filter(|number| number.is_finite()))
        .collect()
}

/// The unit at the end of a name, in brackets.
fn unit_in(name: &str) -> Option<String> {
    let close = name
        .chars()
        .last()
        .filter(|letter| matches!(letter, ']' | ')'))?;
    let open = if close == ']' { '[' } else { '(' };
    let (_, inner) = name[..name.len() - 1].rsplit_once(open)?;
    crate::mapping::Unit::parse(inner.trim()).map(|_| inner.trim().to_owned())
}

/// Whether a row is one of readings: half of its filled cells are numbers, times or lists of numbers, or each says that it has none.
fn is_data(row: &Row) -> bool {
    let filled = row.cells.iter().filter(|cell| !is_missing(cell));
    let is_reading =
        |cell: &str| is_number(cell) || clock::seconds(cell).is_some() || list(cell).is_some();
    let readings = filled.clone().filter(|cell| is_reading(cell)).count();
    let filled = filled.count();
    let says_none = filled == 0 && row.cells.iter().all(|cell| !cell.is_empty());
    says_none || (readings > 0 && 2 * readings >= filled)
}

fn head(grid: &Grid, width: usize, reading: &Reading, name: &str) -> Result<Head, TableError> {
    let comment = || {
        let names = grid.comment.clone()?;
        (names.len() == width && !names.iter().any(|own| is_number(own))).then_some(names)
    };
    if reading.header == Some(false) {
        return Ok(Head {
            names: None,
            units: None,
            rows: 0,
        });
    }
    let is_row = |row: &Row| row.cells.len() == width && is_data(row);
    let first = match (reading.header, grid.rows.iter().position(is_row)) {
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
    let text = |row: usize| above[row].cells.clone();
    let found = Head {
        names: names.map(text).or_else(comment),
        units: units.map(text),
        rows: first,
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
