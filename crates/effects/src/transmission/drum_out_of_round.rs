//! The output drum has two lobes.

use crate::laws::Harmonic;
use crate::{Family, Follows, Hook, LawError, Parameter, Shape, Spec, Unit};

/// The output drum is not round.
pub const SPEC: Spec = Spec {
    name: "drum-out-of-round",
    meaning: "the output drum is not round",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(2 theta - phase)",
    source: "A7",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

pub(crate) const LAW: Harmonic = Harmonic::TWICE;

#[cfg(test)]
crate::conforms!(SPEC);
