//! A ratio error of a joint for which the base model has none, or the pitch of a screw.

use crate::context::Context;
use crate::{
    Absorbed, Effect, Family, Follows, Hook, LawError, Need, Parameter, Signal, Spec, Unit,
};

/// The transmission ratio is not the nominal one.
pub const SPEC: Spec = Spec {
    name: "ratio-error",
    meaning: "the transmission ratio is not the nominal one",
    inspect: "the diameters of the drums, the cable's thickness included",
    adds: "-R_e theta / R",
    source: "D4",
    hook: Hook::Transmission,
    family: Family::Shape,
    needs: &[Need::Chain],
    parameters: &[Parameter::size("ratio_deviation", Unit::One, 0.0, 0.2)],
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByTransmission,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct RatioError {
    pub(crate) joint: usize,
}

impl Effect for RatioError {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        // output = reading / (1 + deviation / ratio), as eq. (1)
        let ratio = context.device.joints[self.joint].transmission_ratio;
        let readings = context.recording.joint[self.joint].iter();
        let error: Vec<f64> = readings.map(|q| -q / ratio).collect();
        vec![context.upstream(self.joint, &error)]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
