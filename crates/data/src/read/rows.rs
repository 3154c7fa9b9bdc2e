//! Text to rows of cells, each row with its line.

use csv::StringRecord;

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::source::TextStream;

/// Bytes that are read at a time.
const BUFFER_BYTES: usize = 1 << 16;

/// The rows of a text, blank lines left out.
#[derive(Debug)]
pub(crate) struct Rows<'r> {
    file: &'r str,
    reader: csv::Reader<TextStream<'r>>,
    record: StringRecord,
}

impl<'r> Rows<'r> {
    /// Rows of a text, which is named `file` in errors.
    pub(crate) fn new(text: TextStream<'r>, file: &'r str) -> Self {
        Self {
            file,
            reader: csv::ReaderBuilder::new()
                .has_headers(false)
                .flexible(true)
                .buffer_capacity(BUFFER_BYTES)
                .from_reader(text),
            record: StringRecord::new(),
        }
    }

    /// The next row with its line, or none at the end.
    ///
    /// The reader's own line is not used: it names the first of the blank lines before a row, and
    /// after a carriage return the line before.
    pub(crate) fn next(&mut self) -> Result<Option<(u64, &StringRecord)>, DataError> {
        let line = loop {
            match self.reader.read_record(&mut self.record) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(error) => return Err(self.refusal(error)),
            }
            let start = self.record.position().map_or(0, csv::Position::byte);
            let line = self.reader.get_mut().line_of(start);
            if self.record.iter().any(|cell| !cell.trim().is_empty()) || self.record.len() > 1 {
                break line;
            }
        };
        if self.reader.get_ref().has_quotes() {
            self.reject_line_breaks(line)?;
        }
        self.reader.get_mut().row_was_taken();
        Ok(Some((line, &self.record)))
    }

    /// Refuses a header whose cells are separated by something else than commas; to be asked after
    /// the first row.
    pub(crate) fn check_separator(&self, line: u64) -> Result<(), DataError> {
        check_separator(&self.reader.get_ref().header_text(), self.file, line)
    }

    /// The damage that explains a refusal of the rows, or the refusal.
    pub(crate) fn explain(&mut self, refusal: DataError) -> DataError {
        self.reader.get_mut().damage().unwrap_or(refusal)
    }

    fn refusal(&mut self, error: csv::Error) -> DataError {
        self.reader.get_mut().take_fault().unwrap_or_else(|| {
            Place::file(self.file).error(Fault::Unreadable {
                source: error.into(),
            })
        })
    }

    fn reject_line_breaks(&self, line: u64) -> Result<(), DataError> {
        match self
            .record
            .iter()
            .position(|cell| cell.contains(['\n', '\r']))
        {
            None => Ok(()),
            Some(index) => {
                let mut at = Place::line(self.file, line);
                at.column_number = Some(index + 1);
                Err(at.error(Fault::UnclosedQuote))
            }
        }
    }
}

/// Refuses a header whose cells are separated by something else than commas.
fn check_separator(header: &str, file: &str, line: u64) -> Result<(), DataError> {
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
    Err(Place::line(file, line).error(Fault::WrongSeparator { saw }))
}

/// Whether blanks separate column names, rather than words of one name such as `theta1 [deg]`.
fn has_words_of_a_header(header: &str) -> bool {
    let mut words = header.split_whitespace();
    words.clone().count() > 1
        && words.any(|word| word == "t_s" || (word.starts_with("theta") && word.contains('_')))
}
