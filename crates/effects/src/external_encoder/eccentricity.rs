//! The disc of an external encoder is off its axis.

use crate::laws::Harmonic;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "external-encoder-eccentricity",
    meaning: "the disc of an external encoder sits off the axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(theta - phase)",
    source: "B1",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Output],
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic;
