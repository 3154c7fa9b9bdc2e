//! Integration tests of the log reader and writer, in one binary.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
#![expect(clippy::print_stdout, reason = "a test without its data says so")]

mod cells;
mod degrees;
mod files;
mod gap_set;
mod gzip;
mod hands;
mod headers;
mod hostile;
mod json_lines;
mod known;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(not(all(feature = "mcap", feature = "parquet", feature = "rosbag2")))]
mod not_built_in;
mod order;
#[cfg(feature = "parquet")]
mod parquet;
mod properties;
mod reading;
#[cfg(feature = "rosbag2")]
mod rosbag2;
mod support;
mod tables;
mod writing;
