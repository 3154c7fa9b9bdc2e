//! Integration tests of the tables, in one binary.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod arrays;
mod guessed;
mod hostile;
mod mapped;
mod matched;
mod same_rows;
mod support;
mod text;
mod turned;
