//! An eccentric drive of a joint for which the base model has none.

use crate::laws::Harmonic;
use crate::{Absorbed, Family, Follows, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// A drum turns off its centre.
pub const SPEC: Spec = Spec {
    name: "drum-eccentricity",
    meaning: "a drum turns off its centre",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(theta - phase)",
    source: "D4",
    hook: Hook::Transmission,
    family: Family::Shape,
    needs: &[Need::Chain],
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByTransmission,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

pub(crate) const LAW: Harmonic = Harmonic::ONCE;

#[cfg(test)]
crate::conforms!(SPEC);
