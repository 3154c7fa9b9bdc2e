//! Bytes of a file to text: decompression, byte order mark, UTF-8.

use std::io::{self, Read};

use flate2::read::MultiGzDecoder;

use crate::error::DataError;
use crate::place::Place;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads everything, decompresses what starts as gzip, and drops a byte order mark.
pub(crate) fn read_text(mut reader: impl Read, name: &str) -> Result<String, DataError> {
    let unreadable = |source| DataError::Unreadable {
        at: Place::file(name),
        source,
    };
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(unreadable)?;
    drop(reader);
    if is_gzip(&bytes) {
        let mut text = Vec::with_capacity(bytes.len().saturating_mul(4));
        // All members, so that a concatenation is not read as its first part only.
        MultiGzDecoder::new(bytes.as_slice())
            .read_to_end(&mut text)
            .map_err(|source| DataError::CorruptGzip {
                at: Place::file(name),
                source,
            })?;
        bytes = text;
    }
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    String::from_utf8(bytes)
        .map_err(|error| not_utf8(name, error.as_bytes(), error.utf8_error().valid_up_to()))
}

/// A single 0x1f counts too: no text starts so, but a gzip file cut after its first byte does.
fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&GZIP_MAGIC) || bytes == &GZIP_MAGIC[..1]
}

/// The place of the first byte that is not UTF-8, and what the file may be.
fn not_utf8(name: &str, bytes: &[u8], valid_up_to: usize) -> DataError {
    let valid = String::from_utf8_lossy(&bytes[..valid_up_to]);
    let line = 1 + valid.matches('\n').count();
    let row = valid.rsplit('\n').next().unwrap_or_default();
    let number = 1 + row.matches(',').count();
    let mut at = Place::line(name, line as u64);
    at.column_number = Some(number);
    if line > 1 {
        let header = valid.lines().next().unwrap_or_default();
        at.column = header
            .split(',')
            .nth(number - 1)
            .map(|cell| cell.trim().to_owned());
    }
    DataError::NotUtf8 {
        at,
        byte: valid_up_to,
        advice: what_it_is(bytes),
    }
}

/// Advice by the first bytes of files that are taken for a log.
fn what_it_is(bytes: &[u8]) -> &'static str {
    const KNOWN: [(&[u8], &str); 7] = [
        (b"\xff\xfe", "it looks like UTF-16: save it as UTF-8"),
        (b"\xfe\xff", "it looks like UTF-16: save it as UTF-8"),
        (
            b"PK\x03\x04",
            "it looks like a spreadsheet or zip archive: export it as CSV",
        ),
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
    ];
    KNOWN
        .iter()
        .find(|(magic, _)| bytes.starts_with(magic))
        .map_or("save it as UTF-8", |(_, advice)| advice)
}

/// What the operating system's answer to opening a file means.
pub(crate) fn open_error(name: &str, source: io::Error) -> DataError {
    let at = Place::file(name);
    if source.kind() == io::ErrorKind::NotFound {
        DataError::NotFound { at }
    } else {
        DataError::Unreadable { at, source }
    }
}
