//! A constant in what the force sensor reads.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Hook, Need, Parameter, Signal, Spec, Unit};

/// A constant in what the force sensor reads.
pub const SPEC: Spec = Spec {
    name: "force-bias",
    meaning: "the force sensor reads a force without one",
    inspect: "its zero, and its temperature",
    adds: "J^T b",
    source: "E1",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("y_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("z_n", Unit::Newton, 0.0, 5.0),
    ],
    amplitudes: 3,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Bias;

impl Effect for Bias {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let axis = |axis: usize| context.sensor(|_| Vector3::ith(axis, 1.0));
        (0..3).map(axis).collect()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        amplitudes.to_vec()
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (values.to_vec(), 0.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
