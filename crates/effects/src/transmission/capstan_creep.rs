//! The wrap slips a little with every loaded travel: d(theta) = kappa tau |d(theta)|.

use haptical_model::transmission::loops::Creep;

use crate::laws::Linear;
use crate::{Family, Form, Hook, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "capstan-creep",
    meaning: "the cable creeps round the drum with loaded travel and does not come back",
    inspect: "the number of turns on the drum and the cable's tension",
    adds: "-kappa sum tau |dtheta|",
    source: "A2",
    hook: Hook::Transmission,
    form: Form::Creep,
    needs: &[Need::Motion, Need::Torque],
    parameters: &[Parameter::size("creep_per_nm", 0.0, 4e-3)],
    is_positive: true,
    scales_with_torque: true,
    log_prior: -1.0,
    ..Spec::of(Family::Drift)
};

pub(crate) const LAW: Linear = Linear(|input| {
    let (torque, travel) = (input.torque_nm()?, input.reading()?);
    let mut error = vec![0.0; travel.len()];
    for run in &input.context.runs {
        let mut creep = Creep::default();
        for row in run.clone() {
            error[row] = creep.step(torque[row], travel[row]);
        }
    }
    Some(vec![error])
});
