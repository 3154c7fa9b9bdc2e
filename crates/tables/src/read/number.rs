//! A cell of a text as a number, and words that are units.

/// What spreadsheets write in a cell without a value.
pub(super) const ERRORS: [&str; 4] = ["#N/A", "#NUM!", "#DIV/0!", "#VALUE!"];

/// Cells that mean no reading.
pub(crate) fn is_missing(cell: &str) -> bool {
    // of Python, spreadsheets, databases, and Microsoft's C library
    matches!(
        cell,
        "" | "nan"
            | "NaN"
            | "NAN"
            | "NA"
            | "N/A"
            | "n/a"
            | "null"
            | "NULL"
            | "None"
            | "-"
            | "--"
            | "1.#QNAN"
            | "-1.#IND"
            | "-nan"
            | "-nan(ind)"
    ) || ERRORS.contains(&cell)
}

/// The number in a cell that is not missing, with this decimal sign. A sign between thousands is not known: `1.234,5` is no number.
pub(super) fn number(cell: &str, decimal: char) -> Option<f64> {
    // words such as `inf` are for the caller
    let begins = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.' | b',');
    if !cell.as_bytes().first().is_some_and(begins) {
        return None;
    }
    if decimal == '.' {
        return cell.parse().ok();
    }
    if cell.contains('.') || cell.matches(',').count() > 1 {
        return None;
    }
    cell.replacen(',', ".", 1).parse().ok()
}

/// Whether a cell is a number with one of the decimal signs.
pub(super) fn is_number(cell: &str) -> bool {
    number(cell, '.').is_some() || number(cell, ',').is_some()
}

/// A cell of a line of units, without its brackets; none where it is no unit.
pub(crate) fn is_unit(cell: &str) -> Option<&str> {
    let bare = cell.trim();
    let inner = ["[]", "()", "<>", "{}"].iter().find_map(|pair| {
        let mut letters = pair.chars();
        bare.strip_prefix(letters.next()?)?
            .strip_suffix(letters.next()?)
    });
    let is_bracketed = inner.is_some();
    let inner = inner.unwrap_or(bare).trim();
    let is_known = crate::mapping::Unit::parse(inner).is_some() || matches!(inner, "-" | "1" | "–");
    (is_known || (is_bracketed && inner.len() <= 12)).then_some(inner)
}
