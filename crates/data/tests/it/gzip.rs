//! Compressed logs, whole and damaged.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use haptical_data::{LoadedLog, read_log_from};

use crate::support::{clean, single};

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// A log of 500 rows whose readings do not repeat.
fn text() -> String {
    let rows: Vec<String> = (0..500)
        .map(|k| format!("{},{}\n", f64::from(k) / 100.0, (f64::from(k) * 0.7).sin()))
        .collect();
    format!("t_s,theta1_rad\n{}", rows.concat())
}

fn read_bytes(bytes: &[u8]) -> Result<LoadedLog, haptical_data::DataError> {
    read_log_from(bytes, "log.csv", &single())
}

#[test]
fn gzip_is_told_by_its_bytes() {
    let log = read_bytes(&gzip(&text())).unwrap();
    assert_eq!(log, clean(&text(), &single()));
    assert_eq!(log.recording.len(), 500);
}

#[test]
fn every_cut_is_an_error() {
    let whole = gzip(&text());
    for end in (1..whole.len())
        .step_by(10)
        .chain(whole.len() - 12..whole.len())
    {
        let error = read_bytes(&whole[..end]).unwrap_err();
        assert_eq!(error.kind(), "corrupt-gzip", "cut at {end}: {error}");
        assert_eq!((error.line(), error.column()), (None, None));
        assert!(
            error.to_string().contains("cut off"),
            "cut at {end}: {error}"
        );
    }
    assert_eq!(read_bytes(&[]).unwrap_err().kind(), "no-header");
}

#[test]
fn every_damaged_byte_of_the_data_is_an_error() {
    let whole = gzip(&text());
    // The ten bytes of the header hold a time and a system that no checksum covers.
    for index in (10..whole.len()).step_by(7) {
        let mut damaged = whole.clone();
        damaged[index] ^= 0x10;
        let error = read_bytes(&damaged).unwrap_err();
        assert_eq!(error.kind(), "corrupt-gzip", "byte {index}: {error}");
    }
}

#[test]
fn all_members_are_read_and_rubbish_after_them_is_an_error() {
    let text = text();
    let (first, second) = text.split_at(text.len() / 2);
    let mut joined = gzip(first);
    joined.extend(gzip(second));
    assert_eq!(read_bytes(&joined).unwrap(), clean(&text, &single()));
    for end in gzip(first).len() + 1..joined.len() {
        assert_eq!(
            read_bytes(&joined[..end]).unwrap_err().kind(),
            "corrupt-gzip",
            "cut at {end}"
        );
    }
    joined.extend(b"0.1,0.2\n");
    assert_eq!(read_bytes(&joined).unwrap_err().kind(), "corrupt-gzip");
}

#[test]
fn what_is_not_text_is_named() {
    let twice = {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&gzip(&text())).unwrap();
        encoder.finish().unwrap()
    };
    let cases: [(&[u8], &str); 3] = [
        (b"\xff\xfet\0_\0s\0", "UTF-16"),
        (b"\x28\xb5\x2f\xfd\xff", "zstd"),
        (&twice, "twice"),
    ];
    for (bytes, words) in cases {
        let error = read_bytes(bytes).unwrap_err();
        assert_eq!((error.kind(), error.line()), ("not-utf8", Some(1)));
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn a_byte_that_is_not_utf8_is_located() {
    let error = read_bytes(b"theta1_rad,contact\n0.1,ok\n0.2,caf\xe9\n").unwrap_err();
    assert_eq!((error.kind(), error.line()), ("not-utf8", Some(3)));
    assert_eq!(
        (error.column_number(), error.column()),
        (Some(2), Some("contact"))
    );
    assert!(error.to_string().contains("byte 33 "), "{error}");
}
