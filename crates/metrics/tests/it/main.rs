//! Integration tests of haptical-metrics.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod bootstrap;
mod budget;
mod coverage;
mod edges;
mod fourier;
mod improvement;
mod inference;
mod pose;
mod quadratic_form;
mod quantile;
mod resamples;
mod saddlepoint;
