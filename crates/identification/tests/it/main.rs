//! Integration tests of `haptical-identification`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod nist;
