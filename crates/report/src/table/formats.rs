//! A table as Markdown, CSV, JSON and HTML.

use maud::{Markup, html};
use serde_json::{Value, json};

use crate::document::with_code;
use crate::error::ReportError;
use crate::table::Table;
use crate::table::cell::{Cell, raw};
use crate::text::clean;

/// Whole numbers up to here are exact in a 64-bit float and written to JSON without a point.
const LARGEST_EXACT_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Columns that a phone has room for side by side.
const PHONE_COLUMNS: usize = 3;

impl Table {
    /// The table as a Markdown table with its title in bold above and its notes below.
    pub fn to_markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = String::new();
        if !self.title.is_empty() {
            text.push_str(&format!("**{}**\n\n", markdown(&self.title)));
        }
        let heads = self
            .columns
            .iter()
            .map(|column| markdown(&column.heading()));
        text.push_str(&line(heads.collect()));
        let rule = |index| {
            if self.is_numeric_column(index) {
                "---:"
            } else {
                ":---"
            }
        };
        let rules = (0..self.columns.len()).map(|index| rule(index).to_owned());
        text.push_str(&line(rules.collect()));
        for row in &self.rows {
            let cells = row.iter().map(|cell| markdown(&cell.display()));
            text.push_str(&line(cells.collect()));
        }
        for note in &self.notes {
            text.push_str(&format!("\n{}\n", markdown(note)));
        }
        text
    }

    /// The table as CSV (RFC 4180, line feeds), numbers with all their digits, without notes.
    ///
    /// The head of a column reads `name [unit]`. A column with intervals becomes two, `name low
    /// [unit]` and `name high [unit]`; other numbers in it fill both. A missing cell is empty.
    ///
    /// # Errors
    /// [`ReportError::Csv`] when the CSV library refuses.
    pub fn to_csv(&self) -> Result<String, ReportError> {
        let failure = |error: csv::Error| ReportError::Csv {
            table: self.title.clone(),
            message: error.to_string(),
        };
        let split = (0..self.columns.len()).map(|index| self.has_intervals(index));
        let split: Vec<bool> = split.collect();
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut head = Vec::new();
        for (column, &split) in self.columns.iter().zip(&split) {
            let ends: &[&str] = if split { &[" low", " high"] } else { &[""] };
            head.extend(ends.iter().map(|end| column.heading_of_end(end)));
        }
        let mut write = |record: &[String]| writer.write_record(record).map_err(failure);
        write(&head)?;
        for row in &self.rows {
            let cells = row.iter().zip(&split);
            let fields = cells.flat_map(|(cell, &split)| csv_fields(cell, split));
            write(&fields.collect::<Vec<String>>())?;
        }
        let bytes = writer
            .into_inner()
            .map_err(|error| failure(error.into_error().into()))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The table as JSON: `title`, `columns` with `name` and `unit`, `rows`, `notes`.
    ///
    /// Numbers are raw, an interval is `[low, high]`, a missing value is `null`.
    pub fn to_json(&self) -> Value {
        let columns = self.columns.iter();
        let columns = columns.map(|column| json!({ "name": column.name, "unit": column.unit }));
        let rows = self.rows.iter();
        let rows = rows.map(|row| row.iter().map(json_cell).collect::<Value>());
        json!({
            "title": self.title,
            "columns": columns.collect::<Value>(),
            "rows": rows.collect::<Value>(),
            "notes": self.notes,
        })
    }

    /// The table as HTML; on a phone a wide one becomes a list of head and value for each row.
    pub fn to_html(&self) -> Markup {
        let class = |index| {
            if self.is_numeric_column(index) {
                "number"
            } else if self.is_short_column(index) {
                "text short"
            } else {
                "text"
            }
        };
        let is_wide = !self.is_narrow();
        let label = |index: usize| is_wide.then(|| clean(&self.columns[index].heading()));
        html! {
            figure.table {
                @if !self.title.is_empty() { figcaption { (clean(&self.title)) } }
                div.scroll tabindex="0" {
                    table.stack[is_wide] {
                        thead { tr {
                            @for (index, column) in self.columns.iter().enumerate() {
                                th class=(class(index)) scope="col" {
                                    (clean(&column.name))
                                    @if !column.unit.is_empty() {
                                        " " span.unit { "[" (clean(&column.unit)) "]" }
                                    }
                                }
                            }
                        } }
                        tbody {
                            @for row in &self.rows { tr {
                                @for (index, cell) in row.iter().enumerate() {
                                    td class=(class(index)) data-label=[label(index)] { (html_cell(cell)) }
                                }
                            } }
                        }
                    }
                }
                @for note in &self.notes { p.note { (with_code(note)) } }
            }
        }
    }

    /// Whether a phone has room for its columns side by side.
    pub(crate) fn is_narrow(&self) -> bool {
        self.columns.len() <= PHONE_COLUMNS
    }

    /// Whether every cell of the column is short enough to stay on one line.
    fn is_short_column(&self, index: usize) -> bool {
        const SHORT: usize = 32;
        let mut cells = self.rows.iter().map(|row| &row[index]);
        cells.all(|cell| cell.display().chars().count() <= SHORT)
    }

    fn has_intervals(&self, index: usize) -> bool {
        let mut cells = self.rows.iter().map(|row| &row[index]);
        cells.any(|cell| matches!(cell, Cell::Interval { .. }))
    }
}

/// Text that Markdown shows as it is, on one line.
fn markdown(text: &str) -> String {
    let escaped = |character: char| match character {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '|' | '\\' | '*' | '`' => format!("\\{character}"),
        _ => character.to_string(),
    };
    clean(text).chars().map(escaped).collect()
}

fn csv_fields(cell: &Cell, split: bool) -> Vec<String> {
    let first = match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number { value, .. } | Cell::Scientific { value, .. } => raw(*value),
        Cell::Interval { low, high, .. } => return vec![raw(*low), raw(*high)],
        Cell::Missing => String::new(),
    };
    if !split {
        return vec![first];
    }
    let second = if cell.is_numeric() {
        first.as_str()
    } else {
        ""
    }
    .to_owned();
    vec![first, second]
}

fn json_cell(cell: &Cell) -> Value {
    match cell {
        Cell::Text(text) => json!(text),
        Cell::Number { value, decimals: 0 }
            if value.fract() == 0.0 && value.abs() <= LARGEST_EXACT_WHOLE =>
        {
            json!(*value as i64)
        }
        Cell::Number { value, .. } | Cell::Scientific { value, .. } => json!(value),
        Cell::Interval { low, high, .. } => json!([low, high]),
        Cell::Missing => Value::Null,
    }
}

/// The cell with a typeset exponent and with line breaks kept.
fn html_cell(cell: &Cell) -> Markup {
    let text = cell.display();
    if let (Cell::Scientific { .. }, Some((mantissa, exponent))) = (cell, text.split_once('e')) {
        let exponent = exponent.replace('-', "\u{2212}");
        return html! { span.one { (mantissa) "\u{2009}×\u{2009}10" sup { (exponent) } } };
    }
    html! {
        @for (index, line) in text.lines().enumerate() {
            @if index > 0 { br; }
            (with_code(line))
        }
    }
}
