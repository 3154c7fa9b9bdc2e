//! URDF in, URDF and MJCF out: against Pinocchio's numbers, an independent product, and hostile text.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test that cannot go on fails there; a skipped one says so"
)]

mod across;
mod across_refusals;
mod branches;
mod corrected;
mod described;
mod friction;
mod hands;
mod includes;
mod inertials;
mod masses;
mod mjcf_masses;
mod mjcf_patch;
mod mjcf_read;
mod motion;
mod names;
mod pinocchio;
mod questions;
mod random;
mod refusals;
mod structure;
mod support;
mod trees;
mod urdf_read;
