//! The text of a log with some cells edited, every other byte as it was.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::ops::Range;

use flate2::Compression;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;

use crate::edit::LogEdits;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::format::Format;
use crate::shape::LogShape;
use crate::write::unwritable;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Digits that an edited number has beyond those of the number before.
const FURTHER_DIGITS: usize = 3;
/// Most digits behind the point.
const MOST_DIGITS: usize = 17;

/// Edits the text of a CSV log that was read from `bytes` as `lines` (the line of each row, [`Recording::line`]), gzip where it
/// was gzip; `None` for a log that is no text (Parquet, MCAP).
///
/// Numbers are written with three digits more behind the point than the cell had. All other bytes stay: spaces, line ends, a
/// byte order mark, columns that nobody reads.
///
/// [`Recording::line`]: haptical_model::Recording::line
///
/// # Errors
/// [`DataError`] where the text is not that of the rows: a line or a column that is edited is not there.
///
/// ```
/// use haptical_data::{JointShape, LogColumn, LogEdits, LogShape, edit_log};
/// let joint = JointShape { name: "1".into(), prismatic: false, lower: -1.0, upper: 1.0 };
/// let shape = LogShape { joints: vec![joint], cable_count: 1, hands: Vec::new() };
/// let mut edits = LogEdits::default();
/// edits.set(LogColumn::Cable(0), 0, 0.2000125);
/// edits.empty(LogColumn::Cable(0), 1);
/// let text = b"theta1_rad, cable_m,mine\r\n0.1, 0.2001,a\r\n0.30,0.4,\"b,c\"\r\n";
/// let edited = edit_log(text, "log.csv", &[2, 3], &edits, &shape)?.ok_or("no text")?;
/// assert_eq!(edited, b"theta1_rad, cable_m,mine\r\n0.1, 0.2000125,a\r\n0.30,,\"b,c\"\r\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn edit_log(
    bytes: &[u8],
    name: &str,
    lines: &[u64],
    edits: &LogEdits,
    shape: &LogShape,
) -> Result<Option<Vec<u8>>, DataError> {
    if Format::detect(bytes) != Format::Text {
        return Ok(None);
    }
    if !bytes.starts_with(&GZIP_MAGIC) {
        return edited(bytes, name, lines, edits, shape).map(Some);
    }
    let mut text = Vec::new();
    MultiGzDecoder::new(bytes)
        .read_to_end(&mut text)
        .map_err(|source| Place::file(name).error(Fault::CorruptGzip { source }))?;
    if Format::detect(&text) != Format::Text {
        return Ok(None);
    }
    let text = edited(&text, name, lines, edits, shape)?;
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    let written = encoder
        .write_all(&text)
        .and_then(|()| encoder.finish())
        .map_err(|source| unwritable(name, source))?;
    Ok(Some(written))
}

/// New cells of a line, by position.
type NewCells = BTreeMap<usize, Option<f64>>;

fn edited(
    text: &[u8],
    name: &str,
    lines: &[u64],
    edits: &LogEdits,
    shape: &LogShape,
) -> Result<Vec<u8>, DataError> {
    let start = if text.starts_with(BYTE_ORDER_MARK) {
        BYTE_ORDER_MARK.len()
    } else {
        0
    };
    let mut all = lines_of(text, start);
    let is_text = |(_, range): &(u64, Range<usize>)| !text[range.clone()].trim_ascii().is_empty();
    let Some((_, header)) = all.find(is_text) else {
        let found = String::new();
        return Err(Place::line(name, 1).error(Fault::NoHeader { found }));
    };
    let names: Vec<String> = cells_of(&text[header.clone()])
        .iter()
        .map(|cell| named(&text[header.clone()][cell.clone()]))
        .collect();
    let mut wanted: BTreeMap<u64, NewCells> = BTreeMap::new();
    for (column, cells) in edits.columns() {
        let wanted_name = column.name(shape);
        let place = names.iter().position(|other| *other == wanted_name);
        let place = place.ok_or_else(|| elsewhere(name, 1, &wanted_name))?;
        for (row, value) in cells {
            let line = lines.get(*row);
            let line = line.ok_or_else(|| elsewhere(name, *row as u64 + 2, &wanted_name))?;
            wanted.entry(*line).or_default().insert(place, *value);
        }
    }
    let mut written = Vec::with_capacity(text.len() + 16 * wanted.len());
    let mut copied = 0;
    for (line, range) in all {
        let Some(cells) = wanted.remove(&line) else {
            continue;
        };
        let places = cells_of(&text[range.clone()]);
        for (index, value) in &cells {
            let Some(place) = places.get(*index) else {
                return Err(elsewhere(name, line, &names[*index]));
            };
            let (from, to) = (range.start + place.start, range.start + place.end);
            let old = &text[from..to];
            let blanks = old.len() - old.trim_ascii_start().len();
            // of an emptied cell nothing is left
            let kept = if value.is_some() { blanks } else { 0 };
            written.extend_from_slice(&text[copied..from + kept]);
            if let Some(value) = value {
                written.extend_from_slice(printed(*value, &old[blanks..]).as_bytes());
            }
            copied = to;
        }
    }
    if let Some((line, _)) = wanted.first_key_value() {
        return Err(elsewhere(name, *line, "its row"));
    }
    written.extend_from_slice(&text[copied..]);
    Ok(written)
}

/// Lines with their numbers and bytes, without their ends: a line feed, a carriage return or both.
fn lines_of(text: &[u8], start: usize) -> impl Iterator<Item = (u64, Range<usize>)> + '_ {
    let (mut at, mut line) = (start, 0);
    std::iter::from_fn(move || {
        if at >= text.len() {
            return None;
        }
        let is_end = |byte: &u8| [b'\n', b'\r'].contains(byte);
        let end = text[at..].iter().position(is_end);
        let end = end.map_or(text.len(), |end| at + end);
        let range = at..end;
        let both = text[end..].starts_with(b"\r\n");
        at = end + if both { 2 } else { 1 };
        line += 1;
        Some((line, range))
    })
}

/// Places of the cells of a line; commas between quotation marks separate nothing.
fn cells_of(line: &[u8]) -> Vec<Range<usize>> {
    let (mut cells, mut start, mut is_quoted) = (Vec::new(), 0, false);
    for (index, byte) in line.iter().enumerate() {
        match byte {
            // a mark within a cell that began without one is a letter; two marks are one of the text
            b'"' if line[start] == b'"' => is_quoted = !is_quoted,
            b',' if !is_quoted => {
                cells.push(start..index);
                start = index + 1;
            }
            _ => {}
        }
    }
    cells.push(start..line.len());
    cells
}

/// A column's name without blanks and quotation marks.
fn named(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let text = text.strip_prefix('"').unwrap_or(&text);
    let text = text.strip_suffix('"').unwrap_or(text);
    text.trim().to_owned()
}

/// A number with a few digits more than the cell had before.
fn printed(value: f64, old: &[u8]) -> String {
    let old = old.trim_ascii().trim_ascii_end();
    let digits = old.iter().rev().position(|byte| *byte == b'.');
    let is_plain = old
        .iter()
        .all(|byte| byte.is_ascii_digit() || b"+-.".contains(byte));
    match digits {
        Some(digits) if is_plain => {
            let digits = (digits + FURTHER_DIGITS).min(MOST_DIGITS);
            format!("{value:.digits$}")
        }
        _ => format!("{value}"),
    }
}

/// The text is not the one that was read.
fn elsewhere(name: &str, line: u64, what: &str) -> DataError {
    let what =
        format!("{what} is not in the text any more; was the log changed while it was read?");
    Place::line(name, line).error(Fault::InvalidRecording { what })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edit::LogColumn;
    use crate::read_log_from;
    use crate::shape::JointShape;

    fn shape() -> LogShape {
        let joint = JointShape {
            name: "1".into(),
            prismatic: false,
            lower: -1.0,
            upper: 1.0,
        };
        LogShape {
            joints: vec![joint],
            cable_count: 1,
            hands: Vec::new(),
        }
    }

    /// Blank lines, a byte order mark, line ends of two kinds, quoted names and cells, signs and exponents.
    const ODD: &str = "\u{feff}\n\"note\",theta1_rad,cable_m,run\r\n\"a, \"\"b\"\"\",1e-1,0.25,1\n\n,+0.2,  .5 ,1\rz,0.30,0.125,1";

    fn edits() -> LogEdits {
        let mut edits = LogEdits::default();
        edits.set(LogColumn::Joint(0), 0, 0.123_456_789);
        edits.set(LogColumn::Cable(0), 1, 0.507_46);
        edits.empty(LogColumn::Cable(0), 2);
        edits
    }

    #[test]
    fn what_is_not_edited_keeps_every_byte() {
        let log = read_log_from(ODD.as_bytes(), "odd.csv", &shape()).unwrap();
        let lines = &log.recording.line;
        let nothing = LogEdits::default();
        let same = edit_log(ODD.as_bytes(), "odd.csv", lines, &nothing, &shape()).unwrap();
        assert_eq!(same.unwrap(), ODD.as_bytes());
        let edited = edit_log(ODD.as_bytes(), "odd.csv", lines, &edits(), &shape()).unwrap();
        let wanted = "\u{feff}\n\"note\",theta1_rad,cable_m,run\r\n\"a, \"\"b\"\"\",0.123456789,0.25,1\n\n,+0.2,  0.5075,1\rz,0.30,,1";
        assert_eq!(String::from_utf8(edited.unwrap()).unwrap(), wanted);
    }

    #[test]
    fn the_edited_text_reads_as_the_edited_recording() {
        let log = read_log_from(ODD.as_bytes(), "odd.csv", &shape()).unwrap();
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(ODD.as_bytes()).unwrap();
        let packed = packed.finish().unwrap();
        let lines = &log.recording.line;
        let edited = edit_log(&packed, "odd.csv.gz", lines, &edits(), &shape())
            .unwrap()
            .unwrap();
        assert!(edited.starts_with(&GZIP_MAGIC));
        let read = read_log_from(&edited[..], "odd.csv.gz", &shape()).unwrap();
        let wanted = edits().made_in(&log.recording);
        assert_eq!(read.recording.joint, wanted.joint);
        let (read, wanted) = (
            read.recording.cable_m[0].as_ref().unwrap(),
            wanted.cable_m[0].as_ref().unwrap(),
        );
        assert!((read[1] - wanted[1]).abs() < 1e-4 && read[2].is_nan() && wanted[2].is_nan());
        assert_eq!(read[0], 0.25);
    }

    #[test]
    fn another_text_is_refused_and_a_table_of_another_kind_is_none() {
        let short = b"theta1_rad,cable_m\n0.1,0.2\n";
        let edited =
            |bytes: &[u8], lines: &[u64]| edit_log(bytes, "log.csv", lines, &edits(), &shape());
        let refused = edited(short, &[2, 3, 4]).unwrap_err();
        assert_eq!(refused.kind(), "invalid-recording");
        assert!(edited(short, &[2]).is_err());
        assert!(edited(b"theta1_rad\n0.1\n", &[2, 3, 4]).is_err());
        assert_eq!(edited(b"PAR1....", &[2]).unwrap(), None);
    }
}
