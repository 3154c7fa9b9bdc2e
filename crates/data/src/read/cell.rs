//! One cell to a number.

use crate::error::Fault;

/// Longest text of the file that an error repeats \[characters\].
const LONGEST_QUOTE: usize = 40;

/// The number in a trimmed cell; `NaN` for an empty one.
pub(crate) fn number(cell: &str) -> Result<f64, Fault> {
    if cell.is_empty() {
        return Ok(f64::NAN);
    }
    let found = || shortened(cell);
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Fault::NotFinite { found: found() }),
        Err(_) if is_spreadsheet_nan(cell) => Err(Fault::NotFinite { found: found() }),
        Err(_) if is_decimal_comma(cell) => Err(Fault::DecimalComma { found: found() }),
        Err(_) => Err(Fault::NotANumber { found: found() }),
    }
}

/// The integer in a trimmed cell. `3.0` counts: spreadsheets and data frames write integers so.
pub(crate) fn integer(cell: &str) -> Result<i64, Fault> {
    if let Ok(value) = cell.parse::<i64>() {
        return Ok(value);
    }
    cell.strip_suffix(".0")
        .and_then(|whole| whole.parse::<i64>().ok())
        .ok_or_else(|| Fault::RunNotInteger {
            found: shortened(cell),
        })
}

/// A text that an error repeats, shortened.
pub(crate) fn shortened(text: &str) -> String {
    let mut letters = text.chars();
    let mut short: String = letters.by_ref().take(LONGEST_QUOTE).collect();
    if letters.next().is_some() {
        short.push_str("...");
    }
    short
}

/// `-nan(ind)`, `1.#INF`, `1.#QNAN`, `#DIV/0!` as C libraries and spreadsheets print them.
fn is_spreadsheet_nan(cell: &str) -> bool {
    let lower = cell.to_ascii_lowercase();
    let bare = lower.trim_start_matches(['+', '-']);
    bare.starts_with("nan(") || bare.starts_with("1.#") || bare == "#div/0!"
}

fn is_decimal_comma(cell: &str) -> bool {
    cell.matches(',').count() == 1 && cell.replacen(',', ".", 1).parse::<f64>().is_ok()
}
