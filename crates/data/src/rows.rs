//! Text to rows of cells, each row with the line it stands on.

use csv::StringRecord;

use crate::error::DataError;
use crate::place::Place;

/// The rows of a text, blank lines left out.
#[derive(Debug)]
pub(crate) struct Rows<'t> {
    file: &'t str,
    text: &'t str,
    reader: csv::Reader<&'t [u8]>,
    record: StringRecord,
    /// Bytes of `text` before `counted` hold `line - 1` line ends.
    counted: usize,
    line: u64,
    has_quotes: bool,
}

impl<'t> Rows<'t> {
    /// Rows of `text`, which is named `file` in errors.
    pub(crate) fn new(text: &'t str, file: &'t str) -> Self {
        Self {
            file,
            text,
            reader: csv::ReaderBuilder::new()
                .has_headers(false)
                .flexible(true)
                .from_reader(text.as_bytes()),
            record: StringRecord::new(),
            counted: 0,
            line: 1,
            has_quotes: text.contains('"'),
        }
    }

    /// The next row with its line, or none at the end.
    pub(crate) fn next(&mut self) -> Result<Option<(u64, &StringRecord)>, DataError> {
        loop {
            let more = self.reader.read_record(&mut self.record).map_err(|error| {
                DataError::Unreadable {
                    at: Place::file(self.file),
                    source: error.into(),
                }
            })?;
            if !more {
                return Ok(None);
            }
            let start = self.record.position().map_or(0, csv::Position::byte);
            self.count_lines(usize::try_from(start).unwrap_or(usize::MAX));
            if self.record.iter().any(|cell| !cell.trim().is_empty()) || self.record.len() > 1 {
                break;
            }
        }
        if self.has_quotes {
            self.reject_line_breaks()?;
        }
        Ok(Some((self.line, &self.record)))
    }

    /// Moves `line` to the row that the reader found from byte `start` on.
    ///
    /// The reader's own line is not used: it names the first of the blank lines before a row, and
    /// after a carriage return the line before.
    fn count_lines(&mut self, start: usize) {
        let bytes = self.text.as_bytes();
        while let Some(&byte) = bytes.get(self.counted) {
            let line_end = byte == b'\n' || byte == b'\r';
            if self.counted >= start && !line_end {
                break;
            }
            self.counted += 1;
            let first_of_two = byte == b'\r' && bytes.get(self.counted) == Some(&b'\n');
            if line_end && !first_of_two {
                self.line += 1;
            }
        }
    }

    fn reject_line_breaks(&self) -> Result<(), DataError> {
        match self
            .record
            .iter()
            .position(|cell| cell.contains(['\n', '\r']))
        {
            None => Ok(()),
            Some(index) => {
                let mut at = Place::line(self.file, self.line);
                at.column_number = Some(index + 1);
                Err(DataError::UnclosedQuote { at })
            }
        }
    }
}

/// Refuses a header whose cells are separated by something else than commas.
pub(crate) fn check_separator(header: &str, file: &str, line: u64) -> Result<(), DataError> {
    const OTHERS: [(char, &str); 3] = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars")];
    let commas = header.matches(',').count();
    let most = OTHERS
        .iter()
        .map(|&(separator, words)| (header.matches(separator).count(), words))
        .max_by_key(|&(count, _)| count);
    let saw = match most {
        Some((count, words)) if count > commas => words,
        _ if commas == 0 && has_words_of_a_header(header) => "spaces",
        _ => return Ok(()),
    };
    Err(DataError::WrongSeparator {
        at: Place::line(file, line),
        saw,
    })
}

/// Whether blanks separate column names, rather than words of one name such as `theta1 [deg]`.
fn has_words_of_a_header(header: &str) -> bool {
    let mut words = header.split_whitespace();
    words.clone().count() > 1
        && words.any(|word| word == "t_s" || (word.starts_with("theta") && word.contains('_')))
}
