//! Effects of an external encoder: nothing else sees them.

pub(crate) mod count_loss;
pub(crate) mod drift;
pub(crate) mod eccentricity;
pub(crate) mod latency;
pub(crate) mod windup;

pub use count_loss::SPEC as COUNT_LOSS;
pub use drift::SPEC as DRIFT;
pub use eccentricity::SPEC as ECCENTRICITY;
pub use latency::SPEC as LATENCY;
pub use windup::SPEC as WINDUP;
