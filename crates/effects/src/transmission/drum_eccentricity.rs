//! An eccentric drive of a joint for which the base model has none.

use crate::laws::Harmonic;
use crate::{Absorbed, Hook, Need, Spec};

/// A drum turns off its centre.
pub const SPEC: Spec = Spec {
    name: "drum-eccentricity",
    meaning: "a drum turns off its centre",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(theta - phase)",
    source: "D4",
    hook: Hook::Transmission,
    needs: &[Need::Chain],
    absorbed_by: Absorbed::ByTransmission,
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic;
