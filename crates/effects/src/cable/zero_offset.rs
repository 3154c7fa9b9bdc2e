//! The zero of the cable encoder is set wrong.

use crate::cable::EXIT;
use crate::laws::Linear;
use crate::{Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-zero-offset",
    meaning: "the zero of the measuring cable is not where the device file says",
    inspect: "the reference length of the cable encoder",
    adds: "constant",
    source: "C2",
    parameters: &[Parameter::size("offset_m", 0.0, 0.05)],
    ..EXIT
};

pub(crate) const LAW: Linear = Linear(|input| Some(vec![vec![1.0; input.context.rows()]]));
