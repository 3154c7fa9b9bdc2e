//! What is found of the readings by the noise model.

mod noise_level;
mod outliers;

pub use noise_level::SPEC as NOISE_LEVEL;
pub use outliers::SPEC as OUTLIERS;
