//! The disc of an external encoder is off its axis.

use crate::laws::Harmonic;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Shape, Spec, Unit};

/// The disc of an external encoder sits off the axis.
pub const SPEC: Spec = Spec {
    name: "external-encoder-eccentricity",
    meaning: "the disc of an external encoder sits off the axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(theta - phase)",
    source: "B1",
    hook: Hook::ExternalEncoder,
    family: Family::Shape,
    needs: &[Need::Output],
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

pub(crate) const LAW: Harmonic = Harmonic::ONCE;

#[cfg(test)]
crate::conforms!(SPEC);
