//! Each axis of the force sensor lags in a loop, Dahl's state of the force.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::context::Context;
use crate::signal::{dahl, smooth};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// Each axis of the force sensor lags in a loop, Dahl's state of the force.
pub const SPEC: Spec = Spec {
    name: "force-hysteresis",
    meaning: "the force sensor reads differently while loading and unloading",
    inspect: "its mounting and overload",
    adds: "J^T h(F), Dahl's state per axis",
    source: "E4",
    hook: Hook::ForceSensor,
    family: Family::Loop,
    needs: &[Need::Time, Need::Torque, Need::Force],
    parameters: &[
        Parameter::size("x_n", Unit::Newton, 0.0, 2.0),
        Parameter::size("y_n", Unit::Newton, 0.0, 2.0),
        Parameter::size("z_n", Unit::Newton, 0.0, 2.0),
        Parameter::transition("transition_n", Unit::Newton, f64::MAX),
    ],
    amplitudes: 3,
    shape: Shape::Continuous(&SHARES),
    follows: Follows::Force,
    law_error: LawError::LOOP,
    ..Spec::COMMON
};

/// Transitions that are tried, over the force's root mean square.
const SHARES: [f64; 3] = [0.1, 0.4, 1.5];
/// Samples on each side over which the force is averaged before its reversals are counted.
const REACH: usize = 4;

fn averaged_n(context: &Context<'_>, axis: usize) -> Vec<f64> {
    smooth(&context.read_force_n(axis), REACH, &context.runs)
}

#[derive(Debug)]
pub(crate) struct Hysteresis;

impl Effect for Hysteresis {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// Shares of the force's root mean square.
    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let axes = (0..3).map(|axis| averaged_n(context, axis));
        let square: f64 = axes
            .map(|force| force.iter().map(|n| n * n).sum::<f64>() / force.len().max(1) as f64)
            .sum();
        SHARES.iter().map(|share| share * square.sqrt()).collect()
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let axis = |axis: usize| {
            let state = dahl(&averaged_n(context, axis), shape, &context.runs);
            context.sensor(|row| Vector3::ith(axis, state[row]))
        };
        (0..3).map(axis).collect()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [amplitudes, &[shape]].concat()
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (values[..3].to_vec(), values[3])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
