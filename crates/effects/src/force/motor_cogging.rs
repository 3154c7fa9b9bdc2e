//! A torque at a multiple of the motor's angle.

use crate::laws::{Input, Law, from_polar, polar, waves};
use crate::{Family, Follows, Form, Hook, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "motor-cogging",
    meaning: "the motor's torque ripples as it turns",
    inspect: "the motor and its commutation",
    adds: "A cos(n R theta - phase)",
    source: "E7",
    hook: Hook::Torque,
    form: Form::Harmonic(None),
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        Parameter::size("amplitude_nm", 0.0, 0.3).times_ratio(),
        Parameter::phase(),
        Parameter::number("order", f64::MAX),
    ],
    amplitudes: 2,
    follows: Follows::Angle,
    ..Spec::of(Family::Shape)
};

/// Of a joint that slides: a force.
pub(crate) const OF_SLIDE: Spec = Spec {
    parameters: &[
        Parameter::size("amplitude_n", 0.0, 30.0).times_ratio(),
        Parameter::phase(),
        Parameter::number("order", f64::MAX),
    ],
    ..SPEC
};

/// Highest order that is tried.
pub const COGGING_ORDERS: usize = 12;
/// Periods that the travel must show.
const LEAST_PERIODS: f64 = 2.0;

pub(crate) const LAW: MotorCogging = MotorCogging;

#[derive(Debug)]
pub(crate) struct MotorCogging;

impl Law for MotorCogging {
    /// Orders of which the travel shows periods enough: fewer look like any other function of the angle.
    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let angle = input.reading()?;
        let low = angle.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ratio = input.joint()?.transmission_ratio;
        let turns = ratio.abs() * (high - low) / std::f64::consts::TAU;
        let orders = (1..=COGGING_ORDERS).map(|order| order as f64);
        Some(
            orders
                .filter(|order| order * turns >= LEAST_PERIODS)
                .collect(),
        )
    }

    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let periods = shape * input.joint()?.transmission_ratio;
        Some(waves(&input.motion()?.value, periods).to_vec())
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [polar(amplitudes), vec![shape]].concat()
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (from_polar(values), values[2])
    }
}
