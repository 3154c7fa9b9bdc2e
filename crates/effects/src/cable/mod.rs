//! Effects of the cable encoder: the cable alone sees them.

use crate::{Family, Follows, Hook, Need, Spec};

pub(crate) mod count_loss;
pub(crate) mod drift;
pub(crate) mod drum_eccentricity;
pub(crate) mod exit_geometry;
pub(crate) mod further;
pub(crate) mod hysteresis;
pub(crate) mod latency;
pub(crate) mod sag;
pub(crate) mod scale;
pub(crate) mod stretch;
pub(crate) mod twist;
pub(crate) mod warming;
pub(crate) mod zero_offset;

/// What the effects between the cable's exit and its reading have in common.
const EXIT: Spec = Spec {
    hook: Hook::CableSensor,
    needs: &[Need::Cable],
    follows: Follows::ExitAngle,
    ..Spec::of(Family::Exit)
};
