//! The runtime against the model crate, the standard library's functions, and what it promises.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    unreachable_pub,
    reason = "a test that cannot go on fails there; a skipped one says so; exported constants panic \
              in the compiler alone"
)]

mod against_effects;
mod against_model;
mod devices;
mod effect_lists;
mod effects_of_torques;
mod exported;
mod exported_effects;
mod instructions;
mod no_allocation;
mod no_panic;
mod refusals;
mod torques;
