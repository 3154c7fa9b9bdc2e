//! Effects of an external encoder: nothing else sees them.

pub(crate) mod count_loss;
pub(crate) mod drift;
pub(crate) mod eccentricity;
pub(crate) mod latency;
pub(crate) mod windup;
