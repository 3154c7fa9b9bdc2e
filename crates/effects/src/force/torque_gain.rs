//! The scale of a drive's torque.

use crate::context::Context;
use crate::{Absorbed, Effect, Family, Follows, Hook, Need, Parameter, Signal, Spec, Unit};

/// The scale of a drive's torque.
pub const SPEC: Spec = Spec {
    name: "torque-gain",
    meaning: "the torque's scale is not the stated one",
    inspect: "the motor's constant and the amplifier's gain",
    adds: "s tau",
    source: "E8",
    hook: Hook::Torque,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque],
    parameters: &[Parameter::size("gain", Unit::One, 0.0, 1.0)],
    follows: Follows::Torque,
    absorbed_by: Absorbed::ByTorqueScale,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct TorqueGain {
    pub(crate) joint: usize,
}

impl Effect for TorqueGain {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let torque_nm = context.torque_nm[self.joint].clone();
        let torque_nm = torque_nm.unwrap_or_else(|| vec![0.0; context.rows()]);
        vec![context.drive(self.joint, torque_nm)]
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
