//! Tests of the monitor, on numbers alone.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on fails there"
)]

mod bounded;
mod judged;
mod python;
mod streams;
