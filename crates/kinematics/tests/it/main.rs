//! Integration tests of `haptical-kinematics`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod closed_form;
mod derivatives;
mod edges;
mod invariance;
mod pinocchio;
mod prepared;
mod refusals;
mod support;
mod trigonometry;
