//! Least squares of torques: whitened rows, the columns of the base model, and what is known of their numbers.

pub(crate) mod base;
pub(crate) mod column;
pub(crate) mod file_effects;
pub(crate) mod problem;
pub(crate) mod system;
pub(crate) mod trimmed;
