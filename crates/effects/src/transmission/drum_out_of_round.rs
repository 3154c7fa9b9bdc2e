//! The output drum has two lobes.

use crate::laws::Harmonic;
use crate::{Hook, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "drum-out-of-round",
    meaning: "the output drum is not round",
    inspect: "the drum's run-out with a dial gauge",
    adds: "A cos(2 theta - phase)",
    source: "A7",
    hook: Hook::Transmission,
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic::TWICE;
