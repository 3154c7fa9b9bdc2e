//! Logs that are made to fill the memory, and logs as large as a log may be.

use std::cell::Cell;
use std::io::{Read, Write};
use std::rc::Rc;

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_data::{DataError, read_log_from};

use crate::support::{read, refused, single};

const MEBIBYTE: usize = 1 << 20;
/// Read beyond a limit before it is noticed: buffers of the reader and the decompressor.
const READ_AHEAD: usize = 256 << 10;

/// Repeats `pattern` for ever after `start`, and counts what is taken.
struct Endless {
    start: &'static [u8],
    pattern: &'static [u8],
    taken: Rc<Cell<usize>>,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        for byte in buffer.iter_mut() {
            let at = self.taken.get();
            *byte = match self.start.get(at) {
                Some(byte) => *byte,
                None => self.pattern[(at - self.start.len()) % self.pattern.len()],
            };
            self.taken.set(at + 1);
        }
        Ok(buffer.len())
    }
}

/// The error of a log that does not end, and the bytes that were taken before it.
fn endless(start: &'static [u8], pattern: &'static [u8]) -> (DataError, usize) {
    let taken = Rc::new(Cell::new(0));
    let source = Endless {
        start,
        pattern,
        taken: Rc::clone(&taken),
    };
    let error = read_log_from(source, "log.csv", &single()).unwrap_err();
    (error, taken.get())
}

#[test]
fn a_line_that_does_not_end_is_refused_at_its_limit() {
    let (error, taken) = endless(b"theta1_rad\n0.1\n", b"1");
    assert_eq!((error.kind(), error.line()), ("line-too-long", Some(3)));
    assert!(error.to_string().contains("longer than 1 MiB"), "{error}");
    assert!(taken < MEBIBYTE + READ_AHEAD, "{taken}");
    // A header alike, and one that is all separators.
    for pattern in [&b"theta1_rad,"[..], b",", b" "] {
        let (error, taken) = endless(b"", pattern);
        assert_eq!((error.kind(), error.line()), ("line-too-long", Some(1)));
        assert!(taken < MEBIBYTE + READ_AHEAD, "{taken}");
    }
}

#[test]
fn text_without_rows_that_does_not_end_is_refused_at_its_limit() {
    for pattern in [&b"\n"[..], b"\r\n", b" \n", b"\t\r"] {
        let (error, taken) = endless(b"theta1_rad\n0.1\n", pattern);
        assert_eq!(error.kind(), "no-row", "{error}");
        assert!(error.to_string().contains("2 MiB"), "{error}");
        assert!(taken < 2 * MEBIBYTE + READ_AHEAD, "{taken}");
    }
    // The quotation mark opens on line 2.
    let (error, taken) = endless(b"theta1_rad,contact\n0.1,\"", b"0.1,a\n");
    assert_eq!((error.kind(), error.line()), ("no-row", Some(2)));
    assert!(error.to_string().contains("quotation mark"), "{error}");
    assert!(taken < 2 * MEBIBYTE + READ_AHEAD, "{taken}");
}

#[test]
fn zero_bytes_are_refused_where_they_begin() {
    let (error, taken) = endless(b"theta1_rad,cable_m\n0.1,0.2\n0.3,", b"\0");
    assert_eq!((error.kind(), error.line()), ("nul-byte", Some(3)));
    assert_eq!(
        (error.column_number(), error.column()),
        (Some(2), Some("cable_m"))
    );
    assert!(error.to_string().contains("loss of power"), "{error}");
    assert!(taken < READ_AHEAD, "{taken}");
    let wide: Vec<u8> = "theta1_rad\n".bytes().flat_map(|byte| [byte, 0]).collect();
    let error = read_log_from(wide.as_slice(), "log.csv", &single()).unwrap_err();
    assert!(error.to_string().contains("UTF-16"), "{error}");
}

#[test]
fn a_small_file_that_decompresses_to_a_large_one_is_refused() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(b"theta1_rad\n").unwrap();
    let piece = vec![b'7'; MEBIBYTE];
    for _ in 0..64 {
        encoder.write_all(&piece).unwrap();
    }
    let bytes = encoder.finish().unwrap();
    assert!(bytes.len() < MEBIBYTE / 10);
    let error = read_log_from(bytes.as_slice(), "log.csv.gz", &single()).unwrap_err();
    assert_eq!((error.kind(), error.line()), ("line-too-long", Some(2)));
}

#[test]
fn the_longest_line_and_the_most_columns_are_read() {
    let header: Vec<String> = (0..4095).map(|index| format!("c{index}")).collect();
    let header = format!("theta1_rad,{}\n", header.join(","));
    let row = format!("0.1{}\n", ",0.123456789012345678901234567890".repeat(4095));
    let text = format!("{header}{row}{row}");
    let log = read(&text, &single()).unwrap();
    assert_eq!(log.recording.covariates.len(), 4095);
    let one_more = text.replacen('\n', ",one\n", 1);
    refused(&one_more, &single(), "too-many-columns", Some(1), None);

    let blanks = " ".repeat(MEBIBYTE - "0.1".len());
    let longest = format!("theta1_rad\n0.1\n{blanks}0.1\r\n0.2\n");
    assert_eq!(
        read(&longest, &single()).unwrap().recording.joint[0],
        [0.1, 0.1, 0.2]
    );
    let longer = format!("theta1_rad\n0.1\n {blanks}0.1\r\n0.2\n");
    refused(&longer, &single(), "line-too-long", Some(3), None);
}

#[test]
fn rows_far_apart_are_read_with_their_lines() {
    let blank = "\n".repeat(MEBIBYTE);
    let text = format!("theta1_rad{blank}0.1{blank}x\n");
    let line = 1 + 2 * MEBIBYTE as u64;
    refused(
        &text,
        &single(),
        "not-a-number",
        Some(line),
        Some((1, "theta1_rad")),
    );
}

#[test]
fn long_names_are_refused_or_shortened() {
    let id = "i".repeat(256);
    let text = format!("theta1_rad,contact\n0.1,{id}\n0.2,\n");
    assert_eq!(
        read(&text, &single()).unwrap().recording.contact.unwrap()[0],
        id
    );
    let text = text.replace(&id, &(id.clone() + "i"));
    let error = refused(&text, &single(), "long-id", Some(2), Some((2, "contact")));
    assert!(error.to_string().contains("257 bytes"), "{error}");

    let name = "n".repeat(100_000);
    let text = format!("theta1_rad,{name}\n0.1,nan\n0.2,0\n");
    let error = read(&text, &single()).unwrap_err();
    assert!(error.to_string().len() < 300, "{}", error.to_string().len());
    let number = "1".repeat(100_000);
    let error = read(&format!("{number}\n{number}\n"), &single()).unwrap_err();
    assert_eq!(error.kind(), "no-header");
    assert!(error.to_string().len() < 300, "{}", error.to_string().len());
}

#[test]
fn characters_and_line_ends_are_whole_wherever_the_reader_cuts() {
    /// Gives one byte at a time.
    struct Drops<'t>(&'t [u8]);
    impl Read for Drops<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let count = self.0.len().min(buffer.len()).min(1);
            let (now, later) = self.0.split_at(count);
            buffer[..count].copy_from_slice(now);
            self.0 = later;
            Ok(count)
        }
    }
    let text = "\u{feff}theta1_rad,contact\r\n\r\n0.1,\u{e9}\u{4e2d}\u{10ffff}\r0.2,\n";
    let whole = read(text, &single()).unwrap();
    let dropped = read_log_from(Drops(text.as_bytes()), "log.csv", &single()).unwrap();
    assert_eq!(whole, dropped);
    assert_eq!(whole.recording.line, [3, 4]);
    for cut in [
        &b"theta1_rad\n0.1\n\xe4\xb8"[..],
        b"theta1_rad\n0.1\n\xe4\xb8,\n",
    ] {
        let error = read_log_from(Drops(cut), "log.csv", &single()).unwrap_err();
        assert_eq!((error.kind(), error.line()), ("not-utf8", Some(3)));
        assert!(error.to_string().contains("byte 15 "), "{error}");
    }
}
