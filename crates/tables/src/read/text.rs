//! A text to rows of cells: comments, quotation marks, separators.

use csv::StringRecord;
use haptical_data::{MOST_COLUMNS, MOST_MEMORY_BYTES};

use super::grid::{Grid, Row, to_table};
use super::number::ERRORS;
use super::{decode, dialect};
use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::{Dialect, Table};

/// Signs that a line of comment begins with.
const COMMENTS: [char; 2] = ['#', '%'];

/// Longest line \[bytes\], as of a log.
const LONGEST_LINE_BYTES: usize = 1 << 20;
/// Lines, and bytes of them, that are looked at for the separator.
const SAMPLE_LINES: usize = 200;
/// See [`SAMPLE_LINES`].
const SAMPLE_BYTES: usize = 1 << 20;
/// Memory of a cell besides its letters \[bytes\].
const CELL_BYTES: u64 = 40;

/// Rows as they come, as far as the memory goes.
struct Rows<'n> {
    rows: Vec<Row>,
    memory_bytes: u64,
    name: &'n str,
}

impl Rows<'_> {
    /// Refuses a row of more cells than a log has.
    fn check(&self, cells: usize, line: u64) -> Result<(), TableError> {
        if cells <= MOST_COLUMNS {
            return Ok(());
        }
        let what = format!("{cells} cells, at most {MOST_COLUMNS} are read");
        let next = "check that its line ends were not lost";
        Err(TableError::new("too-many-columns", what, self.name, next).at(line, None))
    }

    fn push(&mut self, line: u64, cells: Vec<String>) -> Result<(), TableError> {
        let letters = cells.iter().map(|cell| cell.len() as u64 + CELL_BYTES);
        self.memory_bytes += letters.sum::<u64>();
        self.rows.push(Row { line, cells });
        match self.memory_bytes > MOST_MEMORY_BYTES {
            true => Err(TableError::too_large(self.name).at(line, None)),
            false => Ok(()),
        }
    }
}

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
    let is_comment = |line: &str| {
        let line = line.trim_start();
        line.starts_with(&comments[..]) && !ERRORS.iter().any(|error| line.starts_with(error))
    };
    if let Some(line) = (body.lines()).position(|line| line.len() > LONGEST_LINE_BYTES) {
        let what = format!("the line is longer than {} MiB", LONGEST_LINE_BYTES >> 20);
        let next = "check that its line ends were not lost";
        let refusal = TableError::new("line-too-long", what, name, next);
        return Err(refusal.at(skipped + line as u64 + 1, None));
    }
    let mut seen = 0;
    let sample: Vec<&str> = (body.lines())
        .filter(|line| !line.trim().is_empty() && !is_comment(line))
        .take(SAMPLE_LINES)
        .take_while(|line| {
            let is_enough = seen > SAMPLE_BYTES;
            seen += line.len();
            !is_enough
        })
        .collect();
    let separator = match reading.separator()? {
        Some(separator) => separator,
        None => dialect::separator(&sample),
    };
    let mut rows = Rows {
        rows: Vec::new(),
        memory_bytes: 0,
        name,
    };
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
        )?,
        false => {
            for (line, number) in body.lines().zip(skipped + 1..) {
                if is_comment(line) {
                    if rows.rows.is_empty() {
                        comment = Some(
                            line.trim_start()
                                .trim_start_matches(&comments[..])
                                .to_owned(),
                        );
                    }
                } else if !line.trim().is_empty() {
                    let count = match separator {
                        ' ' => line.split_whitespace().count(),
                        _ => line.matches(separator).count() + 1,
                    };
                    rows.check(count, number)?;
                    rows.push(number, dialect::cells(line, separator))?;
                }
            }
        }
    }
    let rows = rows.rows;
    let numeric = rows.iter().flat_map(|row| &row.cells).map(String::as_str);
    let decimal = match reading.decimal()? {
        Some(decimal) => decimal,
        None => dialect::decimal(numeric),
    };
    let names = comment.map(|comment| dialect::cells(comment.trim(), separator));
    let mut table = to_table(
        &Grid {
            rows,
            comment: names,
            is_cut: !text.ends_with(['\n', '\r']),
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
            None => return ("", skipped + 1),
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
    rows: &mut Rows<'_>,
    comment: &mut Option<String>,
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
                rows.name,
                "correct the line's quotation marks",
            )
        })?;
        if !more {
            return Ok(());
        }
        let line = skipped + record.position().map_or(1, csv::Position::line);
        let first = record.get(0).unwrap_or_default();
        if is_comment(first) {
            if rows.rows.is_empty() {
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
            rows.check(record.len(), line)?;
            rows.push(
                line,
                record.iter().map(|cell| cell.trim().to_owned()).collect(),
            )?;
        }
    }
}
