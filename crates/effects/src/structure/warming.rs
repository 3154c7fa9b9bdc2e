//! All links grow with temperature: the way from base to handle does.

use nalgebra::Vector3;

use crate::laws::{Input, Law, REFERENCE};
use crate::{Family, Follows, Form, Further, Hook, Need, Parameter, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of all links, see above",
    source: "D8",
    hook: Hook::Structure,
    form: Form::Warming,
    needs: &[Need::Temperature, Need::Chain],
    parameters: &[Parameter::size("m_per_degc", 0.0, 3e-4)],
    further: &[Further::needed("length_m"), REFERENCE],
    follows: Follows::Temperature,
    ..Spec::of(Family::Drift)
};

pub(crate) const LAW: Warming = Warming;

/// Growth of a length that is the recording's mean distance of the first cable, or 1 m.
#[derive(Debug)]
pub(crate) struct Warming;

impl Law for Warming {
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        let context = input.context;
        let warming = context.warming_k.as_ref()?;
        let mean = context.mean_length_m();
        let grown = |row: usize| context.way_from_base(row) * (warming[row] / mean);
        Some(vec![context.handle(|row| (grown(row), Vector3::zeros()))])
    }

    fn further(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Vec<f64> {
        let context = input.context;
        vec![context.mean_length_m(), context.reference_degc]
    }

    fn whole(&self, input: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let longer = input.context.mean_length_m() / further[0];
        (vec![values[0] * longer], 0.0)
    }
}
