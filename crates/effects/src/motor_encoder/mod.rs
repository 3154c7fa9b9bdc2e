//! Effects of the motor encoders.

pub(crate) mod device_encoder_eccentricity;
pub(crate) mod encoder_count_loss;
pub(crate) mod encoder_latency;
pub(crate) mod zero_changed;

pub use zero_changed::SPEC as ZERO_CHANGED;
