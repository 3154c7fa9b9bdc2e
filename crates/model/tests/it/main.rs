//! Tests of the device model: file, parameters, predictions.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod deviations;
mod device_file;
mod evaluation;
mod force;
mod hands;
mod haptic7;
mod inverse;
mod joint;
mod parameters;
mod properties;
mod recording;
mod refusals;
mod rig;
mod rigid_bodies;
mod rows;
mod support;
mod surroundings;
mod trees;
mod warnings;
mod writer;
