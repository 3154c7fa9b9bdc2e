//! Integration tests of `haptical-diagnosis`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod absorbed;
mod arm;
mod cables;
mod clean;
mod columns;
mod dependencies;
mod determinism;
mod floors;
mod gap_sets;
mod lines;
mod moved;
mod named;
mod normal;
mod partial;
mod postures;
mod refusals;
mod settle;
mod several;
mod touches;
mod touching;
