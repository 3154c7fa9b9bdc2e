//! Pitch of the helix and cables that walk or cross: to leading order an even term, and a cubic one where the cable
//! does not start in the middle of its drum.

use crate::laws::{Input, Law};
use crate::{Family, Follows, Form, Further, Hook, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-pitch",
    meaning: "the cable walks along its drum",
    inspect: "the groove and the lead of the cable on the drum",
    adds: "c_2 theta^2 + c_3 theta^3",
    source: "A8",
    hook: Hook::Transmission,
    form: Form::Polynomial,
    parameters: &[Parameter::size("quadratic_per_rad", 0.0, 0.1)],
    further: &[Further::usually("cubic_per_rad2", 0.0)],
    amplitudes: 2,
    follows: Follows::Angle,
    ..Spec::of(Family::Shape)
};

pub(crate) const LAW: CablePitch = CablePitch;

#[derive(Debug)]
pub(crate) struct CablePitch;

impl Law for CablePitch {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let power = |exponent: i32| {
            let powers = input.reading()?.iter().map(|q| q.powi(exponent));
            Some(powers.collect())
        };
        Some(vec![power(2)?, power(3)?])
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[1]]
    }

    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0], further[0]], 0.0)
    }
}
