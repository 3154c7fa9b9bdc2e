//! A table of cells under columns with units, and its form for the terminal.

pub(crate) mod cell;
pub(crate) mod formats;

use comfy_table::{
    Cell as TerminalCell, CellAlignment, ContentArrangement, ContentLineStyle, LineStyle,
    Table as TerminalTable, TableStyle,
};

use crate::error::ReportError;
use crate::table::cell::{Cell, Column};
use crate::text::clean;

/// Light lines around the table, between the columns and under the head.
const LIGHT_BORDERS: TableStyle = TableStyle::new()
    .top_border(LineStyle::new('┌', '─', '┬', '┐'))
    .header_lines(ContentLineStyle::new('│', '│', '│'))
    .header_separator(LineStyle::new('├', '─', '┼', '┤'))
    .content_lines(ContentLineStyle::new('│', '│', '│'))
    .bottom_border(LineStyle::new('└', '─', '┴', '┘'));

/// Rows of cells under columns that carry their units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What the table shows.
    pub title: String,
    columns: Vec<Column>,
    /// Each as wide as `columns`, of finite numbers: [`Table::push`] sees to it.
    rows: Vec<Vec<Cell>>,
    /// Remarks under the table.
    pub notes: Vec<String>,
}

impl Table {
    /// A table without rows.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::{Cell, Column, Table};
    /// let columns = vec![Column::new("joint", ""), Column::new("offset", "mrad")];
    /// let mut table = Table::new("Joint offsets", columns);
    /// table.push(vec!["1".into(), Cell::number(-6.0881, 3)])?;
    /// assert!(table.to_terminal().contains("-6.088"));
    /// assert_eq!(table.to_csv()?, "joint,offset [mrad]\n1,-6.0881\n");
    /// # Ok::<(), haptical_report::ReportError>(())
    /// ```
    pub fn new(title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self {
            title: title.into(),
            columns,
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// A table without rows; heads are separated by `|`, a unit in brackets ends one.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::{Column, Table};
    /// let table = Table::with_heads("Joint offsets", "joint | offset [mrad]");
    /// assert_eq!(table.columns(), [Column::new("joint", ""), Column::new("offset", "mrad")]);
    /// ```
    pub fn with_heads(title: impl Into<String>, heads: &str) -> Self {
        let column = |head: &str| match head.trim().strip_suffix(']') {
            Some(head) => {
                let (name, unit) = head.rsplit_once('[').unwrap_or((head, ""));
                Column::new(name.trim_end(), unit)
            }
            None => Column::new(head.trim(), ""),
        };
        Self::new(title, heads.split('|').map(column).collect())
    }

    /// The table with these rows added.
    ///
    /// # Errors
    /// As [`Table::push`].
    pub fn with_rows(
        mut self,
        rows: impl IntoIterator<Item = Vec<Cell>>,
    ) -> Result<Self, ReportError> {
        rows.into_iter().try_for_each(|row| self.push(row))?;
        Ok(self)
    }

    /// The table with a remark under it.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Some columns of the table, without its notes; columns that it has not are left out.
    #[must_use]
    pub fn narrowed(&self, columns: &[usize]) -> Self {
        fn kept<T: Clone>(all: &[T], columns: &[usize]) -> Vec<T> {
            let kept = columns.iter().filter_map(|&column| all.get(column));
            kept.cloned().collect()
        }
        let rows = self.rows.iter().map(|row| kept(row, columns));
        Self {
            rows: rows.collect(),
            ..Self::new(&self.title, kept(&self.columns, columns))
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`ReportError::RowWidth`] when the row is not as wide as the table,
    /// [`ReportError::NonFinite`] when a number in it is NaN or infinite.
    pub fn push(&mut self, row: Vec<Cell>) -> Result<(), ReportError> {
        if row.len() != self.columns.len() {
            return Err(ReportError::RowWidth {
                table: self.title.clone(),
                expected: self.columns.len(),
                got: row.len(),
            });
        }
        for (cell, column) in row.iter().zip(&self.columns) {
            if let Some(value) = cell.numbers().into_iter().find(|value| !value.is_finite()) {
                let place = format!("table \"{}\", column \"{}\"", self.title, column.name);
                return Err(ReportError::NonFinite {
                    place,
                    index: self.rows.len(),
                    value,
                });
            }
        }
        self.rows.push(row);
        Ok(())
    }

    /// Heads of the columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }

    /// The table for a terminal: title, light borders, notes; numbers are at the right.
    ///
    /// The lines are as long as the cells need. There is no line end after the last line.
    pub fn to_terminal(&self) -> String {
        let mut table = TerminalTable::new();
        table.load_style(LIGHT_BORDERS);
        table.set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(self.columns.iter().enumerate().map(|(index, column)| {
            TerminalCell::new(clean(&column.heading())).set_alignment(self.alignment(index))
        }));
        for row in &self.rows {
            table.add_row(row.iter().enumerate().map(|(index, cell)| {
                let lines: Vec<String> = cell.display().lines().map(clean).collect();
                TerminalCell::new(lines.join("\n")).set_alignment(self.alignment(index))
            }));
        }
        let mut parts = Vec::new();
        if !self.title.is_empty() {
            parts.push(clean(&self.title));
        }
        parts.push(table.to_string());
        parts.extend(self.notes.iter().map(|note| clean(note)));
        parts.join("\n")
    }

    /// True when the column holds numbers only, apart from missing cells.
    pub(crate) fn is_numeric_column(&self, index: usize) -> bool {
        let cells = self.rows.iter().map(|row| &row[index]);
        let mut cells = cells.filter(|cell| **cell != Cell::Missing);
        let first = cells.next();
        first.is_some_and(Cell::is_numeric) && cells.all(Cell::is_numeric)
    }

    fn alignment(&self, index: usize) -> CellAlignment {
        if self.is_numeric_column(index) {
            CellAlignment::Right
        } else {
            CellAlignment::Left
        }
    }
}
