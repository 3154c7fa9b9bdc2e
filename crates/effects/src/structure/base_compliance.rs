//! The mount of the robot turns against the cable encoder by C M, M the moment of hand and weights about the base.

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The base tilts with the load.
pub const SPEC: Spec = Spec {
    name: "base-compliance",
    meaning: "the base tilts with the load",
    inspect: "screws and table under the device",
    adds: "see above",
    source: "D6",
    hook: Hook::Structure,
    family: Family::Load,
    needs: &[Need::Chain, Need::BaseMoment],
    parameters: &[Parameter::size(
        "rad_per_nm",
        Unit::RadianPerNewtonMetre,
        0.0,
        1e-2,
    )],
    follows: Follows::Force,
    is_positive: true,
    law_error: LawError::LOAD,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct BaseCompliance;

impl Effect for BaseCompliance {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(moment) = &context.base_moment_nm else {
            return vec![];
        };
        vec![context.handle(|row| (moment[row].cross(&context.way_from_base(row)), moment[row]))]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
