//! The measuring cable is longer under the tension of its spring.

use crate::laws::Proportional;
use crate::{Absorbed, Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// The measuring cable is longer under its own tension.
pub const SPEC: Spec = Spec {
    name: "cable-stretch",
    meaning: "the measuring cable is longer under its own tension",
    inspect: "the spring's force and the cable's stiffness",
    adds: "s L",
    source: "C8",
    hook: Hook::CableSensor,
    family: Family::Exit,
    needs: &[Need::Cable],
    parameters: &[Parameter::size("scale", Unit::One, 0.0, 0.05)],
    follows: Follows::ExitAngle,
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-scale"],
    law_error: LawError::EXIT,
    ..Spec::COMMON
};

pub(crate) const LAW: Proportional = Proportional;

#[cfg(test)]
crate::conforms!(SPEC);
