//! The measuring drum's radius is not the stated one.

use crate::cable::EXIT;
use crate::laws::Linear;
use crate::{Absorbed, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-scale",
    meaning: "the measuring drum's radius is not the stated one",
    inspect: "the drum with a length standard",
    adds: "s L",
    source: "C1",
    parameters: &[Parameter::size("scale", 0.0, 0.05)],
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-stretch"],
    ..EXIT
};

pub(crate) const LAW: Linear = Linear::PROPORTIONAL;
