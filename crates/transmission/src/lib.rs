//! Angle errors of capstan, parallelogram and polynomial transmissions, with derivatives and inverse.
//!
//! Every error is an angle that is added to the reading of the motor-side encoder: the output axis
//! stands at `theta + error(theta)`, where `theta` is the motor angle over the nominal ratio. Lengths
//! are in metres, angles in radians. The crate needs neither an allocator nor the standard library.
//!
//! | item | law | source |
//! | --- | --- | --- |
//! | [`Capstan`] | ratio deviation, two eccentric drums, offset | Baser & Konukseven eq. (1) |
//! | [`Parallelogram`] | four-bar loop with four wrong lengths | Baser & Konukseven eq. (2), corrected |
//! | [`CapstanParallelogram`] | the first driving the second | cascade of the two |
//! | [`chebyshev`] | polynomial over a stated range | the paper's 10th-order polynomial |
//! | [`invert`] | angle of the encoder for a wanted angle of the output | safeguarded Newton |
#![no_std]

mod capstan;
mod cascade;
pub mod chebyshev;
mod drum;
mod error;
mod evaluation;
mod inverse;
mod parallelogram;

pub use capstan::{Capstan, CapstanError};
pub use cascade::CapstanParallelogram;
pub use error::TransmissionError;
pub use evaluation::Evaluation;
pub use inverse::invert;
pub use parallelogram::Parallelogram;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
