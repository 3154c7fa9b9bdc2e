//! Integration tests of `haptical-linalg`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod apart;
mod covariance_and_damping;
mod extremes;
mod faer_traps;
mod information;
mod lanes;
mod nalgebra_oracle;
mod normal_equations;
mod ordered_columns;
mod planted;
mod refusals;
mod support;
mod triangles;
