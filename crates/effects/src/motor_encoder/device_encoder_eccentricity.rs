//! The first order of the motor's angle, which the base model has for its input drum.

use crate::laws::Harmonic;
use crate::{Absorbed, Form, Hook, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "device-encoder-eccentricity",
    meaning: "the disc of a motor encoder sits off its axis",
    inspect: "the mounting of that encoder",
    adds: "A cos(R theta - phase)",
    source: "A11",
    hook: Hook::Transmission,
    form: Form::Harmonic(None),
    absorbed_by: Absorbed::ByInputDrum,
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic;
