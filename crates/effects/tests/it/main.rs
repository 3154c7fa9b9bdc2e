//! Tests of the crate from outside.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod catalogue;
mod correction;
mod drives;
