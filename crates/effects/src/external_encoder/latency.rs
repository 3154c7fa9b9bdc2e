//! An external encoder is sampled late.

use crate::laws::Delay;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// An external encoder is sampled later or earlier than the motor encoders.
pub const SPEC: Spec = Spec {
    name: "external-encoder-latency",
    meaning: "an external encoder is sampled later or earlier than the motor encoders",
    inspect: "the time stamps of its channel",
    adds: "theta(t - d) - theta(t)",
    source: "B5",
    hook: Hook::ExternalEncoder,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion, Need::Output],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::Speed,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

pub(crate) const LAW: Delay = Delay;

#[cfg(test)]
crate::conforms!(SPEC);
