//! Binary logs that a build without their feature does not read: refused by name, with the way out.

use haptical_data::read_log_from;

use crate::support::single;

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_is_named() {
    refused(b"PAR1\x15\x04\x15", "Parquet", "--features parquet");
}

#[cfg(not(feature = "mcap"))]
#[test]
fn mcap_is_named() {
    refused(b"\x89MCAP0\r\n\x01", "MCAP", "--features mcap");
}

#[cfg(not(feature = "rosbag2"))]
#[test]
fn rosbag2_is_named() {
    refused(b"SQLite format 3\0\x10", "SQLite", "--features rosbag2");
}

#[track_caller]
fn refused(content: &[u8], format: &str, advice: &str) {
    let error = read_log_from(content, "log", &single()).unwrap_err();
    assert_eq!(error.kind(), "not-built-in", "{error}");
    let text = error.to_string();
    assert!(text.contains(format) && text.contains(advice), "{text}");
    assert!(text.starts_with("log: "), "{text}");
}
