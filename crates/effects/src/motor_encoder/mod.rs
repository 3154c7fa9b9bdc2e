//! Effects of the motor encoders.

pub(crate) mod device_encoder_eccentricity;
pub(crate) mod encoder_count_loss;
pub(crate) mod encoder_latency;

pub use device_encoder_eccentricity::SPEC as DEVICE_ENCODER_ECCENTRICITY;
pub use encoder_count_loss::SPEC as ENCODER_COUNT_LOSS;
pub use encoder_latency::SPEC as ENCODER_LATENCY;
