//! Devices and random numbers that the tests of several crates share.
//!
#![doc = include_str!("../README.md")]

mod devices;
mod random;

pub use devices::{HAPTIC7, arm, haptic7, planar};
pub use random::Random;
