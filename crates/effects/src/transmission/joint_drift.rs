//! The zero of a drive drifts in time, steadily or until it settles.

use crate::context::Context;
use crate::laws::{COURSES, course};
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The joint's zero drifts with time or temperature.
pub const SPEC: Spec = Spec {
    name: "joint-drift",
    meaning: "the joint's zero drifts with time or temperature",
    inspect: "warm-up, and the cable's tension before and after",
    adds: "c t",
    hook: Hook::Transmission,
    family: Family::Drift,
    needs: &[Need::Time],
    parameters: &[Parameter::size(
        "rad_per_s",
        Unit::RadianPerSecond,
        0.0,
        5e-4,
    )],
    shape: Shape::Listed(&COURSES),
    look_alikes: &["capstan-creep"],
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct JointDrift {
    pub(crate) joint: usize,
}

impl Effect for JointDrift {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        vec![context.upstream(self.joint, &course(context, shape))]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
