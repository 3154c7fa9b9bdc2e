//! The measuring drum's radius is not the stated one.

use crate::laws::Proportional;
use crate::{Absorbed, Family, Follows, Hook, LawError, Need, Parameter, Spec, Unit};

/// The measuring drum's radius is not the stated one.
pub const SPEC: Spec = Spec {
    name: "cable-scale",
    meaning: "the measuring drum's radius is not the stated one",
    inspect: "the drum with a length standard",
    adds: "s L",
    source: "C1",
    hook: Hook::CableSensor,
    family: Family::Exit,
    needs: &[Need::Cable],
    parameters: &[Parameter::size("scale", Unit::One, 0.0, 0.05)],
    follows: Follows::ExitAngle,
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["cable-stretch"],
    law_error: LawError::EXIT,
    ..Spec::COMMON
};

pub(crate) const LAW: Proportional = Proportional;

#[cfg(test)]
crate::conforms!(SPEC);
