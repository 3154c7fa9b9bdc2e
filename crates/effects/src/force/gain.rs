//! Scales of the force sensor's axes.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, Need, Parameter, Signal, Spec, Unit};

/// Scales of the force sensor's axes.
pub const SPEC: Spec = Spec {
    name: "force-gain",
    meaning: "the force sensor's scale is not the stated one",
    inspect: "its calibration with a weight",
    adds: "J^T diag(F)",
    source: "E2",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x", Unit::One, 0.0, 0.2),
        Parameter::size("y", Unit::One, 0.0, 0.2),
        Parameter::size("z", Unit::One, 0.0, 0.2),
    ],
    amplitudes: 3,
    follows: Follows::Force,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Gain;

impl Effect for Gain {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let axis = |axis: usize| {
            let read_n = context.read_force_n(axis);
            context.sensor(|row| Vector3::ith(axis, read_n[row]))
        };
        (0..3).map(axis).collect()
    }

    // the law's force is what the sensor read, that is 1 + gain times what acted
    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        amplitudes.iter().map(|a| a / (1.0 - a).max(0.01)).collect()
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (values.iter().map(|gain| gain / (1.0 + gain)).collect(), 0.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
