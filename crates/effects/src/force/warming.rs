//! A constant that grows with temperature, in what the force sensor reads.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, Need, Parameter, Signal, Spec, Unit};

/// A constant that grows with temperature, in what the force sensor reads.
pub const SPEC: Spec = Spec {
    name: "force-bias",
    meaning: "the force sensor reads a force without one",
    inspect: "its zero, and its temperature",
    adds: "J^T b, J^T b_T dT",
    source: "E1",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force, Need::Temperature],
    parameters: &[
        Parameter::size("x_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("y_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("z_n", Unit::Newton, 0.0, 5.0),
        Parameter::size("x_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
        Parameter::size("y_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
        Parameter::size("z_n_per_k", Unit::NewtonPerKelvin, 0.0, f64::MAX),
    ],
    amplitudes: 6,
    follows: Follows::Temperature,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Warming;

impl Effect for Warming {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let warming_k = context.warming_k.as_deref().unwrap_or_default();
        let kelvin = |row: usize| warming_k.get(row).copied().unwrap_or(0.0);
        let constant = (0..3).map(|axis| context.sensor(|_| Vector3::ith(axis, 1.0)));
        let warm = (0..3).map(|axis| context.sensor(|row| Vector3::ith(axis, kelvin(row))));
        constant.chain(warm).collect()
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
