//! The wrap slips a little with every loaded travel: d(theta) = kappa tau |d(theta)|.

use crate::context::Context;
use crate::{Effect, Family, Hook, LawError, Need, Parameter, Signal, Spec, Unit};

/// The cable creeps round the drum with loaded travel and does not come back.
pub const SPEC: Spec = Spec {
    name: "capstan-creep",
    meaning: "the cable creeps round the drum with loaded travel and does not come back",
    inspect: "the number of turns on the drum and the cable's tension",
    adds: "-kappa sum tau |dtheta|",
    source: "A2",
    hook: Hook::Transmission,
    family: Family::Drift,
    needs: &[Need::Motion, Need::Torque],
    parameters: &[Parameter::size(
        "creep_per_nm",
        Unit::PerNewtonMetre,
        0.0,
        4e-3,
    )],
    is_positive: true,
    scales_with_torque: true,
    log_prior: -1.0,
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct CapstanCreep {
    pub(crate) joint: usize,
}

impl Effect for CapstanCreep {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(torque) = context.torque_nm.get(self.joint).and_then(Option::as_ref) else {
            return vec![];
        };
        let travel = &context.recording.joint[self.joint];
        let mut error = vec![0.0; context.rows()];
        for run in &context.runs {
            let mut crept = 0.0;
            for row in run.clone().skip(1) {
                let mean = 0.5 * (torque[row] + torque[row - 1]);
                crept -= mean * (travel[row] - travel[row - 1]).abs();
                error[row] = crept;
            }
        }
        vec![context.upstream(self.joint, &error)]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
