//! Tests of the batch: against the chain's own derivatives and differences.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod allocation;
mod derivatives;
mod pose_lanes;
mod refusals;
mod support;
mod trigonometry;
