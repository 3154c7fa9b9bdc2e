//! Friction and spring of the cable encoder: a loop in the distance.

use crate::laws::{AHEAD, Input, Law, ahead, signed};
use crate::signal::{dahl, smooth};
use crate::{Family, Follows, Further, Hook, Need, Parameter, Shape, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-hysteresis",
    meaning: "the cable encoder reads differently on the way in and out",
    inspect: "friction of its spring, drum and guide",
    adds: "Dahl's loop in L",
    source: "C7",
    hook: Hook::CableSensor,
    needs: &[Need::Motion, Need::Cable],
    parameters: &[Parameter::size("amplitude_m", 0.0, 1e-2)],
    further: &[Further::usually("transition_m", 2e-3), AHEAD],
    shape: Shape::Continuous(&[2e-4, 2e-3, 0.01, 0.05, 0.2]),
    follows: Follows::CableSpeed,
    ..Spec::of(Family::Loop)
};

pub(crate) const LAW: Hysteresis = Hysteresis;

#[derive(Debug)]
pub(crate) struct Hysteresis;

impl Law for Hysteresis {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        // rounding of the readings must not look like reversals
        let runs = &input.context.runs;
        let length = smooth(input.reading()?, 2, runs);
        Some(vec![dahl(&length, shape, runs)])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[0].abs()]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], 2e-3)
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![shape, ahead(amplitudes)]
    }

    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (vec![signed(values[0], further[1])], further[0])
    }
}
