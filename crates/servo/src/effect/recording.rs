//! Faults of a recording that no law of a servo describes.

pub(crate) const DEAD: &str = "dead-joint";
pub(crate) const SWAPPED: &str = "joints-swapped";
pub(crate) const CLIPPED: &str = "clipped";
pub(crate) const LOST: &str = "lost-rows";
pub(crate) const REPEATED: &str = "repeated-rows";
pub(crate) const MISSING: &str = "dropouts";
