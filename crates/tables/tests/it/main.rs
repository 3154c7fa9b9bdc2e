//! Integration tests of the tables, in one binary.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "helpers of tests fail the test"
)]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

mod arrays;
mod formats;
mod guessed;
mod hostile;
mod makers;
mod mapped;
mod matched;
mod same_rows;
mod support;
mod text;
mod turned;
