//! One axis of the force sensor reads part of the force along another.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, Need, Parameter, Signal, Spec, Unit};

/// One axis of the force sensor reads part of the force along another.
pub const SPEC: Spec = Spec {
    name: "force-crosstalk",
    meaning: "a force along one axis shows on another",
    inspect: "how the force sensor is turned on the handle",
    adds: "J^T X F, X without diagonal",
    source: "E3",
    hook: Hook::ForceSensor,
    family: Family::Stated,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("xy", Unit::One, 0.0, 0.2),
        Parameter::size("xz", Unit::One, 0.0, 0.2),
        Parameter::size("yx", Unit::One, 0.0, 0.2),
        Parameter::size("yz", Unit::One, 0.0, 0.2),
        Parameter::size("zx", Unit::One, 0.0, 0.2),
        Parameter::size("zy", Unit::One, 0.0, 0.2),
    ],
    amplitudes: 6,
    follows: Follows::Force,
    ..Spec::COMMON
};

/// Axes that read too much, and whose force it is.
const ENTRIES: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

#[derive(Debug)]
pub(crate) struct Crosstalk;

impl Effect for Crosstalk {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let entry = |(to, from): (usize, usize)| {
            let read_n = context.read_force_n(from);
            context.sensor(|row| Vector3::ith(to, read_n[row]))
        };
        ENTRIES.map(entry).to_vec()
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
