//! Fits that hold off wild readings.

pub(crate) mod automatic;
pub(crate) mod reweighted;
