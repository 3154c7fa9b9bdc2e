//! A text to rows of cells: comments, quotation marks, separators.

use csv::StringRecord;

use super::grid::{Grid, Row, to_table};
use super::{decode, dialect};
use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::{Dialect, Table};

/// Signs that a line of comment begins with.
const COMMENTS: [char; 2] = ['#', '%'];

pub(super) fn read(bytes: &[u8], name: &str, reading: &Reading) -> Result<Table, TableError> {
    let encoding = reading.encoding.as_deref();
    let (text, is_latin1) = decode::text(bytes, encoding, name)?;
    let mut notes = Vec::new();
    if is_latin1 && encoding.is_none() {
        notes.push(format!("{name}: read as Latin-1, it is no UTF-8"));
    }
    let (body, skipped) = without_first(&text, reading.skip_lines.unwrap_or(0));
    let comments: Vec<char> = match &reading.comment {
        Some(sign) => sign.chars().take(1).collect(),
        None => COMMENTS.to_vec(),
    };
    let is_comment = |line: &str| line.trim_start().starts_with(&comments[..]);
    let sample: Vec<&str> = (body.lines())
        .filter(|line| !line.trim().is_empty() && !is_comment(line))
        .collect();
    let separator = match reading.separator()? {
        Some(separator) => separator,
        None => dialect::separator(&sample),
    };
    let mut rows = Vec::new();
    // the last comment before the first row may have the names
    let mut comment = None;
    match body.contains('"') && separator != ' ' {
        true => quoted(
            body,
            skipped,
            separator,
            &is_comment,
            &mut rows,
            &mut comment,
            name,
        )?,
        false => {
            for (line, number) in body.lines().zip(skipped + 1..) {
                if is_comment(line) {
                    if rows.is_empty() {
                        comment = Some(
                            line.trim_start()
                                .trim_start_matches(&comments[..])
                                .to_owned(),
                        );
                    }
                } else if !line.trim().is_empty() {
                    rows.push(Row {
                        line: number,
                        cells: dialect::cells(line, separator),
                    });
                }
            }
        }
    }
    let numeric = rows.iter().flat_map(|row| &row.cells).map(String::as_str);
    let decimal = match reading.decimal()? {
        Some(decimal) => decimal,
        None => dialect::decimal(numeric),
    };
    let names = comment.map(|comment| dialect::cells(comment.trim(), separator));
    let mut table = to_table(
        Grid {
            rows,
            comment: names,
        },
        decimal,
        name,
        reading,
    )?;
    table.notes.splice(0..0, notes);
    table.dialect = Some(Dialect {
        separator,
        decimal,
        is_latin1,
        has_units: table.columns.iter().any(|column| column.unit.is_some()),
    });
    Ok(table)
}

/// The text behind its first lines, and how many these are.
fn without_first(text: &str, lines: usize) -> (&str, u64) {
    let mut rest = text;
    let mut skipped = 0;
    for _ in 0..lines {
        match rest.split_once('\n') {
            Some((_, behind)) => rest = behind,
            None => rest = "",
        }
        skipped += 1;
    }
    (rest, skipped)
}

/// Rows of a text with quotation marks: a cell may go over several lines.
fn quoted(
    body: &str,
    skipped: u64,
    separator: char,
    is_comment: &impl Fn(&str) -> bool,
    rows: &mut Vec<Row>,
    comment: &mut Option<String>,
    name: &str,
) -> Result<(), TableError> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator as u8)
        .from_reader(body.as_bytes());
    let mut record = StringRecord::new();
    loop {
        let more = reader.read_record(&mut record).map_err(|error| {
            let what = format!("cannot be read: {error}");
            TableError::new(
                "unreadable",
                what,
                name,
                "correct the line's quotation marks",
            )
        })?;
        if !more {
            return Ok(());
        }
        let line = skipped + record.position().map_or(1, csv::Position::line);
        let first = record.get(0).unwrap_or_default();
        if is_comment(first) {
            if rows.is_empty() {
                let words: Vec<&str> = record.iter().collect();
                let sign = |letter: char| COMMENTS.contains(&letter);
                *comment = Some(
                    words
                        .join(&separator.to_string())
                        .trim_start_matches(sign)
                        .to_owned(),
                );
            }
        } else if record.len() > 1 || !first.trim().is_empty() {
            let cells = record.iter().map(|cell| cell.trim().to_owned()).collect();
            rows.push(Row { line, cells });
        }
    }
}
