//! Integration tests of `haptical-motion`, in one binary.
#![allow(
    clippy::unwrap_used,
    reason = "clippy.toml allows it in test functions; helpers of tests are meant too"
)]

mod arm;
mod between;
mod commands;
mod found;
mod identified;
mod laws;
mod noise;
mod recorded;
mod second;
mod several;
mod without_gravity;
