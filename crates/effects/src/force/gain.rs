//! Scales of the force sensor's axes.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::force::SENSOR;
use crate::laws::{Input, Law};
use crate::{Form, Parameter, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "force-gain",
    meaning: "the force sensor's scale is not the stated one",
    inspect: "its calibration with a weight",
    form: Form::Scale,
    adds: "J^T diag(F)",
    source: "E2",
    parameters: &[
        Parameter::size("x", 0.0, 0.2),
        Parameter::size("y", 0.0, 0.2),
        Parameter::size("z", 0.0, 0.2),
    ],
    amplitudes: 3,
    ..SENSOR
};

pub(crate) const LAW: Gain = Gain;

#[derive(Debug)]
pub(crate) struct Gain;

impl Law for Gain {
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        let axis = |axis: usize| {
            let read_n = input.context.read_force_n(axis);
            input.context.sensor(|row| Vector3::ith(axis, read_n[row]))
        };
        Some((0..3).map(axis).collect())
    }

    // the law's force is what the sensor read, that is 1 + gain times what acted
    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        amplitudes.iter().map(|a| a / (1.0 - a).max(0.01)).collect()
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (values.iter().map(|gain| gain / (1.0 + gain)).collect(), 0.0)
    }
}
