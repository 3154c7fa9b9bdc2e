//! Integration tests of `haptical-dynamics`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod closed_form;
mod energy;
mod inertia;
mod laws;
mod peers;
mod refusals;
mod support;
