//! The cable encoder is sampled late.

use crate::laws::Delay;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// The cable encoder is sampled later or earlier than the joints.
pub const SPEC: Spec = Spec {
    name: "cable-latency",
    meaning: "the cable encoder is sampled later or earlier than the joints",
    inspect: "the time stamps of its channel",
    adds: "L(t - d) - L(t)",
    source: "C13",
    hook: Hook::CableSensor,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::CableSpeed,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

pub(crate) const LAW: Delay = Delay;

#[cfg(test)]
crate::conforms!(SPEC);
