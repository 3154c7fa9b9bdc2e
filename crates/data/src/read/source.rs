//! Bytes of a log to a checked stream of text: decompression, byte order mark, UTF-8, lengths.

use std::collections::VecDeque;
use std::io::{self, BufReader, Cursor, Read};

use flate2::bufread::MultiGzDecoder;
use memchr::{memchr, memchr3};

use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::format::{MCAP_MAGIC, PARQUET_MAGIC};
use crate::size::{LONGEST_GAP_BYTES, LONGEST_LINE_BYTES};

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Text that is decompressed after a refusal, in search of damage \[bytes\].
const SEARCHED_BYTES: u64 = 16 << 20;
/// Bytes that tell what a file is.
pub(crate) const N_FIRST: usize = 16;

/// The text of a log as it comes, so that neither a long line nor a small file that decompresses
/// to a large one fills the memory.
///
/// It passes on what it checks. What it refuses is kept for [`TextStream::take_fault`], since a
/// reader can only fail with an [`io::Error`].
pub(crate) struct TextStream<'r> {
    input: Box<dyn Read + 'r>,
    file: String,
    is_gzip: bool,
    first: Vec<u8>,
    /// Bytes seen, line of the next one and commas before it, and where it began.
    offset: u64,
    line: u64,
    commas: usize,
    line_start: u64,
    is_in_line: bool,
    is_after_return: bool,
    /// First byte and number of each line with text, from the next row on.
    starts: VecDeque<(u64, u64)>,
    /// Bytes seen when the last row was taken.
    last_row: u64,
    has_quotes: bool,
    /// First line with more than blanks, and whether it has ended.
    header: Vec<u8>,
    has_header: bool,
    /// A character of which the rest is in the next piece.
    cut: Vec<u8>,
    fault: Option<DataError>,
}

impl std::fmt::Debug for TextStream<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("TextStream")
            .field("file", &self.file)
            .field("offset", &self.offset)
            .finish_non_exhaustive()
    }
}

impl<'r> TextStream<'r> {
    /// Decompresses what starts as gzip, and drops a byte order mark.
    pub(crate) fn new(reader: impl Read + 'r, file: &str) -> Result<Self, DataError> {
        let unreadable = |source| Place::file(file).error(Fault::Unreadable { source });
        let mut reader = BufReader::new(reader);
        let magic = first_bytes(&mut reader, GZIP_MAGIC.len()).map_err(unreadable)?;
        // A single 0x1f counts too: no text starts so, but a cut gzip file does.
        let is_gzip = magic == GZIP_MAGIC || magic == GZIP_MAGIC[..1];
        let whole = BufReader::new(Cursor::new(magic).chain(reader));
        let mut stream = Self {
            input: if is_gzip {
                // All members, so that a concatenation is not read as its first part only.
                Box::new(MultiGzDecoder::new(whole))
            } else {
                Box::new(whole)
            },
            file: file.to_owned(),
            is_gzip,
            first: Vec::new(),
            offset: 0,
            line: 1,
            commas: 0,
            line_start: 0,
            is_in_line: false,
            is_after_return: false,
            starts: VecDeque::new(),
            last_row: 0,
            has_quotes: false,
            header: Vec::new(),
            has_header: false,
            cut: Vec::new(),
            fault: None,
        };
        let first = first_bytes(&mut stream.input, N_FIRST)
            .map_err(|source| unreadable_or_corrupt(source, file, is_gzip))?;
        let text = first.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&first);
        stream.input = Box::new(Cursor::new(text.to_vec()).chain(stream.input));
        stream.first = first;
        Ok(stream)
    }

    /// Why reading failed, if the text was the reason.
    pub(crate) fn take_fault(&mut self) -> Option<DataError> {
        self.fault.take()
    }

    /// Whether the rest of a gzip file is damaged, as far as it is worth looking: then this is why
    /// its text was refused.
    pub(crate) fn damage(&mut self) -> Option<DataError> {
        if !self.is_gzip {
            return None;
        }
        let mut rest = (&mut self.input).take(SEARCHED_BYTES);
        io::copy(&mut rest, &mut io::sink())
            .err()
            .map(|source| unreadable_or_corrupt(source, &self.file, true))
    }

    /// The first bytes of the text.
    pub(crate) fn first(&self) -> &[u8] {
        (self.first.strip_prefix(BYTE_ORDER_MARK)).unwrap_or(&self.first)
    }

    /// Whether a quotation mark has been seen.
    pub(crate) fn has_quotes(&self) -> bool {
        self.has_quotes
    }

    /// The line of the row whose text begins at byte `start` or after blank lines from there on.
    pub(crate) fn line_of(&mut self, start: u64) -> u64 {
        while self.starts.front().is_some_and(|&(byte, _)| byte < start) {
            self.starts.pop_front();
        }
        self.starts.front().map_or(self.line, |&(_, line)| line)
    }

    /// Says that a row was taken, from which on the next one must not be far.
    pub(crate) fn row_was_taken(&mut self) {
        self.last_row = self.offset;
        self.starts.pop_front();
    }

    /// The first line with more than blanks, as far as it has been seen.
    pub(crate) fn header_text(&self) -> String {
        String::from_utf8_lossy(&self.header).trim().to_owned()
    }

    /// Checks a piece of the text.
    fn check(&mut self, mut piece: &[u8]) -> Result<(), DataError> {
        while !self.cut.is_empty() {
            let Some((&byte, rest)) = piece.split_first() else {
                return Ok(());
            };
            self.cut.push(byte);
            match std::str::from_utf8(&self.cut) {
                Ok(_) => {
                    let whole = std::mem::take(&mut self.cut);
                    self.scan(&whole)?;
                }
                Err(error) if error.error_len().is_none() => {}
                Err(_) => return Err(self.not_utf8()),
            }
            piece = rest;
        }
        match std::str::from_utf8(piece) {
            Ok(_) => self.scan(piece),
            Err(error) => {
                let (valid, rest) = piece.split_at(error.valid_up_to());
                self.scan(valid)?;
                if error.error_len().is_some() {
                    return Err(self.not_utf8());
                }
                rest.clone_into(&mut self.cut);
                Ok(())
            }
        }
    }

    /// Counts lines and commas of valid text, and refuses what no log holds.
    fn scan(&mut self, text: &[u8]) -> Result<(), DataError> {
        self.has_quotes |= memchr(b'"', text).is_some();
        let mut rest = text;
        while !rest.is_empty() {
            let letters = memchr3(b'\n', b'\r', 0, rest).unwrap_or(rest.len());
            let (letters, end) = rest.split_at(letters);
            self.take_letters(letters)?;
            let Some((&byte, after)) = end.split_first() else {
                self.count_commas(letters);
                break;
            };
            if byte == 0 {
                self.count_commas(letters);
                return Err(self.nul_byte());
            }
            self.offset += 1;
            self.end_line(byte);
            rest = after;
        }
        if self.offset - self.last_row > LONGEST_GAP_BYTES {
            let line = self.starts.front().map_or(self.line, |&(_, line)| line);
            return Err(Place::line(&self.file, line).error(Fault::NoRow {
                mebibytes: LONGEST_GAP_BYTES >> 20,
            }));
        }
        Ok(())
    }

    /// An end of line, after it.
    fn end_line(&mut self, byte: u8) {
        let is_rest_of_end = byte == b'\n' && self.is_after_return;
        self.is_after_return = byte == b'\r';
        self.line_start = self.offset;
        if is_rest_of_end {
            return;
        }
        self.line += 1;
        self.commas = 0;
        self.is_in_line = false;
        self.has_header |= !self.header.trim_ascii().is_empty();
        if !self.has_header {
            self.header.clear();
        }
    }

    /// Letters of one line.
    fn take_letters(&mut self, letters: &[u8]) -> Result<(), DataError> {
        if letters.is_empty() {
            return Ok(());
        }
        self.is_after_return = false;
        if !self.is_in_line {
            self.is_in_line = true;
            self.starts.push_back((self.offset, self.line));
        }
        let after = self.offset + letters.len() as u64;
        if after - self.line_start > LONGEST_LINE_BYTES {
            return Err(
                Place::line(&self.file, self.line).error(Fault::LineTooLong {
                    mebibytes: LONGEST_LINE_BYTES >> 20,
                }),
            );
        }
        if !self.has_header {
            self.header.extend_from_slice(letters);
        }
        self.offset = after;
        Ok(())
    }

    /// Commas count in a line that has not ended: the place of what is refused in it.
    fn count_commas(&mut self, letters: &[u8]) {
        self.commas += letters.iter().filter(|byte| **byte == b',').count();
    }

    /// The place of the next byte, with its column where the header is known.
    fn here(&self) -> Box<Place> {
        let mut at = Place::line(&self.file, self.line);
        at.column_number = Some(self.commas + 1);
        if self.has_header {
            at.column = self
                .header_text()
                .split(',')
                .nth(self.commas)
                .map(|cell| cell.trim().to_owned());
        }
        at
    }

    fn not_utf8(&self) -> DataError {
        self.here().error(Fault::NotUtf8 {
            byte: self.offset,
            advice: what_it_is(&self.first).unwrap_or("save it as UTF-8"),
        })
    }

    fn nul_byte(&self) -> DataError {
        if what_it_is(&self.first).is_some() {
            return self.not_utf8();
        }
        let is_wide = self.first.len() >= 2 && self.first[..2].contains(&0);
        self.here().error(Fault::NulByte {
            byte: self.offset,
            advice: if is_wide && self.first.iter().any(|byte| *byte != 0) {
                "it looks like UTF-16: save it as UTF-8"
            } else {
                "the file was damaged, as by a loss of power while it was recorded: delete the row \
                 and what follows it, or record again"
            },
        })
    }

    fn at_end(&self) -> Result<(), DataError> {
        if self.cut.is_empty() {
            Ok(())
        } else {
            Err(self.not_utf8())
        }
    }
}

impl Read for TextStream<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let result = match read_again(&mut self.input, buffer) {
            Ok(0) => self.at_end().map(|()| 0),
            Ok(count) => self.check(&buffer[..count]).map(|()| count),
            Err(source) => Err(unreadable_or_corrupt(source, &self.file, self.is_gzip)),
        };
        result.map_err(|fault| {
            self.fault = Some(fault);
            io::Error::other("the text was refused")
        })
    }
}

/// Reads once, again if a signal came between.
fn read_again(reader: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match reader.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

/// The first `count` bytes, fewer at the end.
pub(crate) fn first_bytes(reader: &mut impl Read, count: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(count);
    reader.take(count as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// What the decompressor finds wrong is the data's fault, the rest the operating system's.
fn unreadable_or_corrupt(source: io::Error, file: &str, is_gzip: bool) -> DataError {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    let at = Place::file(file);
    match source.kind() {
        InvalidData | InvalidInput | UnexpectedEof if is_gzip => {
            at.error(Fault::CorruptGzip { source })
        }
        _ => at.error(Fault::Unreadable { source }),
    }
}

/// Advice by the first bytes of files that are taken for a log.
fn what_it_is(bytes: &[u8]) -> Option<&'static str> {
    const KNOWN: [(&[u8], &str); 8] = [
        (b"\xff\xfe", "it looks like UTF-16: save it as UTF-8"),
        (b"\xfe\xff", "it looks like UTF-16: save it as UTF-8"),
        (
            b"\x28\xb5\x2f\xfd",
            "it looks compressed with zstd: decompress it, or use gzip",
        ),
        (
            b"\xfd7zXZ",
            "it looks compressed with xz: decompress it, or use gzip",
        ),
        (
            b"BZh",
            "it looks compressed with bzip2: decompress it, or use gzip",
        ),
        (&GZIP_MAGIC, "it was compressed twice: decompress it once"),
        (
            &PARQUET_MAGIC,
            "it is a Parquet file that was compressed again: decompress it",
        ),
        (
            &MCAP_MAGIC,
            "it is an MCAP file that was compressed again: decompress it",
        ),
    ];
    KNOWN
        .iter()
        .find(|(magic, _)| bytes.starts_with(magic))
        .map(|(_, advice)| *advice)
}

/// What the operating system's answer to opening a file means.
pub(crate) fn open_error(name: &str, source: io::Error) -> DataError {
    let at = Place::file(name);
    if source.kind() == io::ErrorKind::NotFound {
        at.error(Fault::NotFound)
    } else {
        at.error(Fault::Unreadable { source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a text so many bytes at a time, and says what was refused.
    fn refused(text: &[u8], at_once: usize) -> String {
        let mut stream = TextStream::new(text, "log.csv").unwrap();
        let mut buffer = vec![0; at_once];
        while stream.read(&mut buffer).is_ok_and(|count| count > 0) {}
        stream.take_fault().unwrap().to_string()
    }

    #[test]
    fn the_place_of_a_fault_does_not_depend_on_the_pieces() {
        let text = b"theta1_rad,theta2_rad,out1_rad\r\n0.1,0.2,0.3\r\n0.4,0.5,\0\r\n";
        let whole = refused(text, text.len());
        assert!(
            whole.contains("line 3, column 3 `out1_rad`: byte 53"),
            "{whole}"
        );
        for at_once in 1..text.len() {
            assert_eq!(refused(text, at_once), whole, "{at_once} bytes at a time");
        }
    }
}
