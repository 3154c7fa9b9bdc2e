//! A loop that turns over within a travel, after Dahl, in the transmission.

use crate::laws::Reversal;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// Friction bends the transmission, with the sign of the last motion.
pub const SPEC: Spec = Spec {
    name: "hysteresis",
    meaning: "friction bends the transmission, with the sign of the last motion",
    inspect: "bearings, guides and cables that rub",
    adds: "Dahl's loop",
    source: "A5",
    hook: Hook::Transmission,
    family: Family::Loop,
    needs: &[Need::Motion],
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::transition("transition_rad", Unit::Radian, 5.0),
    ],
    shape: Shape::Continuous(&[3e-4, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0]),
    follows: Follows::Angle,
    log_prior: -0.5,
    law_error: LawError::LOOP,
    ..Spec::COMMON
};

pub(crate) const LAW: Reversal = Reversal;

#[cfg(test)]
crate::conforms!(SPEC);
