//! One axis of the force sensor reads part of the force along another.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::force::SENSOR;
use crate::laws::InStreams;
use crate::{Form, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "force-crosstalk",
    meaning: "a force along one axis shows on another",
    inspect: "how the force sensor is turned on the handle",
    form: Form::Coupling,
    adds: "J^T X F, X without diagonal",
    source: "E3",
    parameters: &[
        Parameter::size("xy", 0.0, 0.2),
        Parameter::size("xz", 0.0, 0.2),
        Parameter::size("yx", 0.0, 0.2),
        Parameter::size("yz", 0.0, 0.2),
        Parameter::size("zx", 0.0, 0.2),
        Parameter::size("zy", 0.0, 0.2),
    ],
    amplitudes: 6,
    ..SENSOR
};

/// Axes that read too much, and whose force it is.
const ENTRIES: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

pub(crate) const LAW: InStreams = InStreams(|input| {
    let entry = |(to, from): (usize, usize)| {
        let read_n = input.context.read_force_n(from);
        input.context.sensor(|row| Vector3::ith(to, read_n[row]))
    };
    Some(ENTRIES.map(entry).to_vec())
});
