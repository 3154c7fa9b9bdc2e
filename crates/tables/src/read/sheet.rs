//! A spreadsheet (.xlsx) to rows of cells.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use calamine::{DataRef, Reader, Xlsx};
use haptical_data::{MOST_COLUMNS, MOST_MEMORY_BYTES};

use super::grid::{Grid, Row, to_table};
use crate::arrays::limited_entries;
use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::Table;

/// Memory of a cell \[bytes\].
const CELL_BYTES: u64 = 48;

pub(super) fn read(bytes: Vec<u8>, name: &str, reading: &Reading) -> Result<Table, TableError> {
    // none of its files unpacks to more than the memory holds
    limited_entries(&bytes, ".xml", name)?;
    // a library that meets what it does not expect may panic; what it was at work on is dropped then
    let read = AssertUnwindSafe(|| cells(bytes, name, reading));
    let rows = catch_unwind(read).unwrap_or_else(|_| Err(damaged("its parts contradict", name)))?;
    // blank rows are no rows, and blank columns at the left and right no columns
    let filled = || rows.values().flat_map(|cells| cells.keys().copied());
    let (Some(first), Some(last)) = (filled().min(), filled().max()) else {
        let next = "name another with `sheet` in [table]";
        return Err(TableError::new(
            "no-rows",
            "the sheet has no cells",
            name,
            next,
        ));
    };
    if (last - first) as usize >= MOST_COLUMNS {
        let what = format!("cells in columns {} to {}", first + 1, last + 1);
        let next = "leave out columns that are not needed";
        return Err(TableError::new("too-many-columns", what, name, next));
    }
    let rows = rows.into_iter().map(|(row, mut cells)| Row {
        line: u64::from(row) + 1,
        cells: (first..=last)
            .map(|column| cells.remove(&column).unwrap_or_default())
            .collect(),
    });
    let grid = Grid {
        rows: rows.collect(),
        comment: None,
        is_cut: false,
    };
    to_table(&grid, '.', name, reading)
}

fn damaged(what: impl std::fmt::Display, name: &str) -> TableError {
    TableError::damaged("spreadsheet's", what, name)
}

/// The cells of a sheet, row by row.
type Cells = BTreeMap<u32, BTreeMap<u32, String>>;

fn cells(bytes: Vec<u8>, name: &str, reading: &Reading) -> Result<Cells, TableError> {
    let mut book = Xlsx::new(Cursor::new(bytes)).map_err(|error| damaged(error, name))?;
    let sheets = book.sheet_names();
    let sheet = match &reading.sheet {
        None => sheets.first().cloned(),
        Some(wanted) => sheets.iter().find(|own| *own == wanted).cloned(),
    };
    let Some(sheet) = sheet else {
        let what = format!(
            "there is no sheet `{}`",
            reading.sheet.as_deref().unwrap_or("")
        );
        let next = format!("the file has: {}", sheets.join(", "));
        return Err(TableError::new("no-sheet", what, name, next));
    };
    let reader = book.worksheet_cells_reader(&sheet);
    let mut reader = reader.map_err(|error| damaged(error, name))?;
    let mut rows = Cells::new();
    let mut memory_bytes = 0;
    while let Some(cell) = reader.next_cell().map_err(|error| damaged(error, name))? {
        let (row, column) = cell.get_position();
        let text = match cell.get_value() {
            DataRef::Empty => continue,
            DataRef::Int(number) => number.to_string(),
            DataRef::Float(number) => number.to_string(),
            DataRef::Bool(so) => u8::from(*so).to_string(),
            DataRef::String(text) => text.trim().to_owned(),
            DataRef::SharedString(text) => text.trim().to_owned(),
            // dates and errors are no numbers
            other => format!("{other:?}"),
        };
        memory_bytes += CELL_BYTES + text.len() as u64;
        if memory_bytes > MOST_MEMORY_BYTES {
            return Err(TableError::too_large(name));
        }
        rows.entry(row).or_default().insert(column, text);
    }
    Ok(rows)
}
