//! The first order of the motor's angle, which the base model has for its input drum.

use crate::laws::Harmonic;
use crate::{Absorbed, Family, Follows, Hook, LawError, Parameter, Shape, Spec, Unit};

/// The disc of a motor encoder sits off its axis.
pub const SPEC: Spec = Spec {
    name: "device-encoder-eccentricity",
    meaning: "the disc of a motor encoder sits off its axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(R theta - phase)",
    source: "A11",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 0.1),
        Parameter::phase(),
    ],
    amplitudes: 2,
    shape: Shape::Listed(&[1.0]),
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByInputDrum,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

pub(crate) const LAW: Harmonic = Harmonic::with(|joint, _| joint.transmission_ratio);

#[cfg(test)]
crate::conforms!(SPEC);
