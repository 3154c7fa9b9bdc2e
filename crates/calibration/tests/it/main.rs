//! Integration tests of `haptical-calibration`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod agreement;
mod chain;
mod counts;
mod derivatives;
mod evidence;
mod force_direction;
mod frame_origins;
mod haptic;
mod held_out;
mod in_bulk;
mod incomplete;
mod invariance;
mod null_space;
mod planted;
mod recovery;
mod refusals;
mod statistics;
mod warnings;
