//! Angle errors of capstan, parallelogram and polynomial transmissions, with derivatives and inverse.
//!
//! Every error is an angle that is added to the reading of the motor-side encoder: the output axis
//! is at `theta + error(theta)`, where `theta` is the motor angle over the nominal ratio. Lengths
//! are in metres, angles in radians. The crate needs neither an allocator nor the standard library.
//!
//! | item | law | source |
//! | --- | --- | --- |
//! | [`Capstan`] | ratio deviation, two eccentric drums, offset | Baser & Konukseven eq. (1) |
//! | [`Parallelogram`] | four-bar loop with four wrong lengths | Baser & Konukseven eq. (2), corrected |
//! | [`CapstanParallelogram`] | the first driving the second | cascade of the two |
//! | [`chebyshev`] | polynomial over a stated range | the paper's 10th-order polynomial |
//! | [`CapstanTerms`], [`FourBar`] | eqs. (1) and (2) without sines and arctangents, for other forms of them | |
//! | [`CapstanRows`] | eq. (1) at many angles at once | |
//! | [`loops`] | play, Dahl's loop, creep, delay: one sample after the other | Prandtl, Dahl 1968 |
//! | [`spline`] | a free curve | de Boor 1978 |
//! | [`invert`] | angle of the encoder for a wanted angle of the output | safeguarded Newton |
#![no_std]

mod capstan;
mod capstan_rows;
mod capstan_terms;
mod cascade;
pub mod chebyshev;
mod error;
mod evaluation;
mod four_bar;
mod inverse;
pub mod loops;
mod parallelogram;
pub mod spline;

pub use capstan::{Capstan, CapstanError};
pub use capstan_rows::CapstanRows;
pub use capstan_terms::{CapstanTerms, Drum, TurnedDrum};
pub use cascade::CapstanParallelogram;
pub use error::LawError;
pub use evaluation::Evaluation;
pub use four_bar::FourBar;
pub use inverse::invert;
pub use parallelogram::Parallelogram;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
