//! Laws of errors: what several effects share, and the one way of all errors of one number into the streams.

mod course;
mod delay;
mod from_run;
mod harmonic;
mod law;
mod linear;
mod reversal;
mod spring;
mod step;
mod warm;

pub(crate) use course::Drift;
pub(crate) use delay::{Delay, moved, slope};
pub(crate) use from_run::{FROM_RUN, first_row, run_of};
pub(crate) use harmonic::{Harmonic, from_polar, polar, waves};
pub(crate) use law::{Input, Law, Placed};
pub(crate) use linear::{InStreams, Linear};
pub(crate) use reversal::{AHEAD, Reversal, ahead, signed};
pub(crate) use spring::Spring;
pub(crate) use step::Step;
pub use step::under_load;
pub(crate) use warm::{REFERENCE, Warm};
