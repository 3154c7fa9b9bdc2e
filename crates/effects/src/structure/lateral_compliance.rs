//! A joint yields across its axis: bearing and link turn by M / k, M the part of the moment of hand and weights beyond the
//! joint, about its origin, that lies across the axis.

use nalgebra::Vector3;

use crate::laws::{Input, Law, Spring};
use crate::{Hook, Need, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "lateral-compliance",
    meaning: "a joint's bearing or link bends across its axis with the load",
    inspect: "the bearing of that joint and the link behind it",
    adds: "see above",
    hook: Hook::Structure,
    needs: &[Need::Chain, Need::BaseMoment],
    scales_with_torque: false,
    log_prior: -1.0,
    ..Spring::SPEC
};

pub(crate) const LAW: LateralCompliance = LateralCompliance;

#[derive(Debug)]
pub(crate) struct LateralCompliance;

impl Law for LateralCompliance {
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        let (context, joint) = (input.context, input.joint?);
        let moment_nm = context.joint_moment_nm.get(joint)?;
        let turned = |row: usize| {
            let lever = context.lever(joint, row).zip(moment_nm.get(row));
            let Some(((axis, arm), moment_nm)) = lever else {
                return (Vector3::zeros(), Vector3::zeros());
            };
            let turn = moment_nm - axis * axis.dot(moment_nm);
            (turn.cross(&arm), turn)
        };
        Some(vec![context.handle(turned)])
    }
}
