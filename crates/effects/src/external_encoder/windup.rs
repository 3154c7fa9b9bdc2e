//! The coupling of an external encoder winds up at reversals, after Dahl.

use crate::laws::Reversal;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// The coupling of an external encoder winds up at each reversal.
pub const SPEC: Spec = Spec {
    name: "external-encoder-windup",
    meaning: "the coupling of an external encoder winds up at each reversal",
    inspect: "the coupling and the bearing of that encoder",
    adds: "Dahl's loop",
    source: "B2",
    hook: Hook::ExternalEncoder,
    family: Family::Loop,
    needs: &[Need::Motion, Need::Output],
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
