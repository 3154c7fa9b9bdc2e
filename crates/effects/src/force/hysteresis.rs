//! Each axis of the force sensor lags in a loop, Dahl's state of the force.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::force::SENSOR;
use crate::laws::{Input, Law};
use crate::signal::{dahl, smooth};
use crate::{Family, Form, LawError, Parameter, Shape, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "force-hysteresis",
    meaning: "the force sensor reads differently while loading and unloading",
    inspect: "its mounting and overload",
    adds: "J^T h(F), Dahl's state per axis",
    source: "E4",
    family: Family::Loop,
    form: Form::Loop,
    parameters: &[
        Parameter::size("x_n", 0.0, 2.0),
        Parameter::size("y_n", 0.0, 2.0),
        Parameter::size("z_n", 0.0, 2.0),
        Parameter::transition("transition_n", f64::MAX),
    ],
    amplitudes: 3,
    shape: Shape::Continuous(&SHARES),
    law_error: LawError::of(Family::Loop),
    ..SENSOR
};

/// Transitions that are tried, over the force's root mean square.
const SHARES: [f64; 3] = [0.1, 0.4, 1.5];
/// Samples on each side over which the force is averaged before its reversals are counted.
const REACH: usize = 4;

fn averaged_n(context: &Context<'_>, axis: usize) -> Vec<f64> {
    smooth(&context.read_force_n(axis), REACH, &context.runs)
}

pub(crate) const LAW: Hysteresis = Hysteresis;

#[derive(Debug)]
pub(crate) struct Hysteresis;

impl Law for Hysteresis {
    /// Shares of the force's root mean square.
    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let axes = (0..3).map(|axis| averaged_n(input.context, axis));
        let square: f64 = axes
            .map(|force| force.iter().map(|n| n * n).sum::<f64>() / force.len().max(1) as f64)
            .sum();
        Some(SHARES.iter().map(|share| share * square.sqrt()).collect())
    }

    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        let axis = |axis: usize| {
            let state = dahl(&averaged_n(input.context, axis), shape, &input.context.runs);
            input.context.sensor(|row| Vector3::ith(axis, state[row]))
        };
        Some((0..3).map(axis).collect())
    }
}
