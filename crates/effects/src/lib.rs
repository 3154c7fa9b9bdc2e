//! Effects that a calibrated model lacks: what each is, what it adds to the measured channels, its numbers.
//!
#![doc = include_str!("../README.md")]

mod catalogue;
mod context;
mod error;
pub mod signal;
#[cfg(test)]
mod tests;

pub use catalogue::{
    Effect, FORCE_NAMES, Family, Hook, Need, ParameterSpec, catalogue, names, under_load,
};
pub use context::{CableGeometry, Context, Stream, Touches, streams};
pub use error::ContextError;
pub use signal::Signal;
