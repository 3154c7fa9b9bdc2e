//! Effects of the cable encoder: the cable alone sees them.

pub(crate) mod count_loss;
pub(crate) mod drift;
pub(crate) mod drum_eccentricity;
pub(crate) mod exit_geometry;
pub(crate) mod hysteresis;
pub(crate) mod latency;
pub(crate) mod sag;
pub(crate) mod scale;
pub(crate) mod stretch;
pub(crate) mod twist;
pub(crate) mod warming;
pub(crate) mod zero_offset;

pub use count_loss::SPEC as COUNT_LOSS;
pub use drift::SPEC as DRIFT;
pub use drum_eccentricity::SPEC as DRUM_ECCENTRICITY;
pub use exit_geometry::SPEC as EXIT_GEOMETRY;
pub use hysteresis::SPEC as HYSTERESIS;
pub use latency::SPEC as LATENCY;
pub use sag::SPEC as SAG;
pub use scale::SPEC as SCALE;
pub use stretch::SPEC as STRETCH;
pub use twist::SPEC as TWIST;
pub use warming::SPEC as WARMING;
pub use zero_offset::SPEC as ZERO_OFFSET;
