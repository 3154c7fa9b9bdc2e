//! Integration tests of the transmission errors, one module per subject.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a failed step fails the test; clippy's own exception ends at functions marked as tests"
)]

mod bad_input;
mod capstan_numbers;
mod capstan_terms;
mod cascade;
mod chebyshev_monomials;
mod chebyshev_series;
mod edges;
mod fixture;
mod inverse;
mod paper;
mod parallelogram;
mod parallelogram_geometry;
mod search;
