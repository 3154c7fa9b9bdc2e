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
mod converged;
mod currents;
mod dependencies;
mod determinism;
mod floors;
mod foreign_torque;
mod further_cables;
mod gap_sets;
mod lines;
#[path = "../../src/force/tests/arm.rs"]
#[allow(dead_code, reason = "shared with the tests of the force test")]
mod mechanics;
mod moved;
mod named;
mod normal;
mod partial;
mod postures;
mod refusals;
mod second;
mod settle;
mod several;
mod touches;
mod touching;
mod untold_loads;
