//! Integration tests of `haptical-identification`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod correlated;
mod cramer_rao;
mod derivative_check;
mod identifiability;
mod intervals;
mod invariance;
mod mgh;
mod nist;
mod observability;
mod profile;
mod refusals;
mod robust;
mod search;
mod support;
mod triangle_form;
