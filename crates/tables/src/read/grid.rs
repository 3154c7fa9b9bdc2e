//! Rows of cells to named columns: which lines are names and units, which columns are numbers, lists within cells.

use super::clock;
use super::dialect::usual;
use super::head::head;
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
    /// Whether the last line lacks its end.
    pub(super) is_cut: bool,
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
    if head.preamble > 0 {
        let lines = head.preamble;
        notes.push(format!(
            "{name}: the first {lines} lines are taken for a preamble"
        ));
    }
    if let Some(note) = &head.note {
        notes.push(format!("{name}: {note}"));
    }
    let mut rows = &grid.rows[head.rows..];
    if let Some((last, before)) = rows.split_last()
        && is_cut(last, before, grid.is_cut, width)
    {
        let line = last.line;
        notes.push(format!(
            "{name}: line {line}, the last, is cut off and left out"
        ));
        rows = before;
    }
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
        euler: head.euler,
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

/// Whether a writer stopped within the last row: it lacks cells, or its line lacks the end and its last cell is no number alone.
fn is_cut(last: &Row, before: &[Row], lacks_end: bool, width: usize) -> bool {
    if before.is_empty() || before.iter().any(|row| row.cells.len() != width) {
        return false;
    }
    let last_cell = |row: &Row| row.cells.last().cloned().unwrap_or_default();
    let cell = last_cell(last);
    let is_whole = is_number(&cell) || (is_missing(&cell) && cell != "-" && !cell.is_empty());
    let lacks_letters = !is_whole && before.iter().all(|row| is_number(&last_cell(row)));
    last.cells.len() < width || (lacks_end && last.cells.len() == width && lacks_letters)
}
