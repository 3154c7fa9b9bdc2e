//! The measuring cable is longer under the tension of its spring.

use crate::cable::EXIT;
use crate::laws::Linear;
use crate::{Absorbed, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-stretch",
    meaning: "the measuring cable is longer under its own tension",
    inspect: "the spring's force and the cable's stiffness",
    adds: "s L",
    source: "C8",
    parameters: &[Parameter::size("scale", 0.0, 0.05)],
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-scale"],
    ..EXIT
};

pub(crate) const LAW: Linear = Linear::PROPORTIONAL;
