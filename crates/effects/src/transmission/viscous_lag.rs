//! The output follows the motor late.

use crate::laws::Delay;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// The joint lags behind its motor in proportion to the speed.
pub const SPEC: Spec = Spec {
    name: "viscous-lag",
    meaning: "the joint lags behind its motor in proportion to the speed",
    inspect: "grease, damping and the load of the transmission",
    adds: "theta(t - d) - theta(t)",
    source: "A6",
    hook: Hook::Transmission,
    family: Family::Lag,
    needs: &[Need::Time, Need::Motion],
    parameters: &[Parameter::size("delay_s", Unit::Second, 0.0, 0.05)],
    follows: Follows::Speed,
    is_positive: true,
    law_error: LawError::LAG,
    ..Spec::COMMON
};

pub(crate) const LAW: Delay = Delay;

#[cfg(test)]
crate::conforms!(SPEC);
