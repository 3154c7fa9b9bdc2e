//! The output drum has two lobes.

use crate::laws::Harmonic;
use crate::{Form, Hook, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "drum-out-of-round",
    meaning: "the output drum is not round",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(2 theta - phase)",
    source: "A7",
    hook: Hook::Transmission,
    form: Form::Harmonic(Some(2.0)),
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic;
