//! A constant in what the force sensor reads, and what it grows by with temperature.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::force::SENSOR;
use crate::laws::{InStreams, Input, REFERENCE, Warm};
use crate::{Follows, Form, Need, Parameter, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "force-bias",
    meaning: "the force sensor reads a force without one",
    inspect: "its zero, and its temperature",
    form: Form::Offset,
    adds: "J^T b",
    source: "E1",
    parameters: &[
        Parameter::size("x_n", 0.0, 5.0),
        Parameter::size("y_n", 0.0, 5.0),
        Parameter::size("z_n", 0.0, 5.0),
    ],
    amplitudes: 3,
    follows: Follows::Time,
    ..SENSOR
};
/// The same with temperature.
pub(crate) const WARM: Spec = Spec {
    adds: "J^T b, J^T b_T dT",
    needs: &[Need::Time, Need::Torque, Need::Force, Need::Temperature],
    parameters: &[
        Parameter::size("x_n", 0.0, 5.0),
        Parameter::size("y_n", 0.0, 5.0),
        Parameter::size("z_n", 0.0, 5.0),
        Parameter::size("x_n_per_k", 0.0, f64::MAX),
        Parameter::size("y_n_per_k", 0.0, f64::MAX),
        Parameter::size("z_n_per_k", 0.0, f64::MAX),
    ],
    further: &[REFERENCE],
    amplitudes: 6,
    follows: Follows::Temperature,
    ..SPEC
};

pub(crate) const LAW: InStreams = InStreams(|input| Some(constant(input)));
/// The constant, and the growth.
pub(crate) const WARM_LAW: Warm<InStreams> = Warm(InStreams(|input| {
    let warming_k = input.context.warming_k.as_deref().unwrap_or_default();
    let kelvin = |row: usize| warming_k.get(row).copied().unwrap_or(0.0);
    let warm = |axis: usize| input.context.sensor(|row| Vector3::ith(axis, kelvin(row)));
    Some([constant(input), (0..3).map(warm).collect()].concat())
}));

fn constant(input: Input<'_, '_>) -> Vec<Signal> {
    let axis = |axis: usize| input.context.sensor(|_| Vector3::ith(axis, 1.0));
    (0..3).map(axis).collect()
}
