//! Single cells of a table as numbers and texts.

use crate::error::TableError;
use crate::table::{Cells, Table};

/// Longest text of a file that an error repeats \[characters\].
const LONGEST_QUOTE: usize = 40;

/// The number in a cell; `NaN` where there is no reading.
pub(super) fn number_of(table: &Table, column: usize, row: usize) -> Result<f64, TableError> {
    let text = match &table.columns[column].cells {
        Cells::Numbers(numbers) => return Ok(numbers[row]),
        Cells::Texts(texts) => &texts[row],
    };
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    // a column of texts may have numbers, with the table's decimal sign
    let point = match table.dialect.as_ref().map(|dialect| dialect.decimal) {
        Some(',') if !text.contains('.') => text.replacen(',', ".", 1),
        Some(',') => String::new(),
        _ => text.clone(),
    };
    let is_word = text.starts_with(|first: char| first.is_alphabetic());
    match point.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(at(
            table,
            column,
            row,
            format!("`{}` is not a finite number", short(text)),
        )),
        Err(_) if is_word || !text.contains(',') => Err(at(
            table,
            column,
            row,
            format!("expected a number, found `{}`", short(text)),
        )),
        Err(_) => {
            let what = format!(
                "expected a number, found `{}`; is the comma a decimal sign, or between thousands?",
                short(text)
            );
            Err(at(table, column, row, what))
        }
    }
}

/// The number of a run.
pub(super) fn integer_of(
    table: &Table,
    column: usize,
    row: usize,
    number: f64,
) -> Result<f64, TableError> {
    match number.fract() == 0.0 && number.abs() < 9e15 {
        true => Ok(number),
        false => Err(at(
            table,
            column,
            row,
            format!("a run is numbered by a whole number, found `{number}`"),
        )),
    }
}

/// The text in a cell; empty where there is none.
pub(super) fn text_of(table: &Table, column: usize, row: usize) -> String {
    match &table.columns[column].cells {
        Cells::Texts(texts) => texts[row].clone(),
        Cells::Numbers(numbers) if numbers[row].is_nan() => String::new(),
        Cells::Numbers(numbers) => numbers[row].to_string(),
    }
}

fn at(table: &Table, column: usize, row: usize, what: String) -> TableError {
    let next = "correct it, or leave the cell empty where there is no reading";
    let refusal = TableError::new("not-a-number", what, &table.file, next);
    refusal.at(table.line(row), Some(column as u64 + 1))
}

fn short(text: &str) -> String {
    text.chars().take(LONGEST_QUOTE).collect()
}
