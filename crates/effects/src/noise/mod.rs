//! Findings of the noise model on the readings.

mod dropouts;
mod noise_level;
mod outliers;
pub(crate) mod periodic_disturbance;

pub use dropouts::SPEC as DROPOUTS;
pub use noise_level::SPEC as NOISE_LEVEL;
pub use outliers::SPEC as OUTLIERS;
