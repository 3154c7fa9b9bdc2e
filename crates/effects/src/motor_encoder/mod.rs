//! Effects of the motor encoders.

mod clocks;
pub(crate) mod device_encoder_eccentricity;
pub(crate) mod encoder_count_loss;
pub(crate) mod encoder_latency;

pub use clocks::{Ahead, OtherClock};
