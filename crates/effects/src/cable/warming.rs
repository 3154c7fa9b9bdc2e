//! The cable and its encoder grow with temperature.

use crate::laws::{Input, Law, REFERENCE};
use crate::{Family, Follows, Further, Hook, LogFault, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of cable and encoder, see above",
    source: "C9",
    hook: Hook::CableSensor,
    needs: &[Need::Temperature, Need::Cable],
    parameters: &[Parameter::size("m_per_degc", 0.0, 3e-4)],
    further: &[
        Further::needed("beyond_m_per_degc"),
        Further::needed("length_m"),
        REFERENCE,
    ],
    amplitudes: 2,
    follows: Follows::Temperature,
    log_fault: Some(LogFault::Drift),
    ..Spec::of(Family::Drift)
};

pub(crate) const LAW: Warming = Warming;

/// A shift at the mean distance (housing and cable), and what grows with the distance beyond that.
#[derive(Debug)]
pub(crate) struct Warming;

impl Law for Warming {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let (warming, length_m) = (input.context.warming_k.as_ref()?, input.reading()?);
        let mean = input.context.mean_length_m();
        let beyond = warming.iter().zip(length_m);
        let beyond = beyond.map(|(warming, length)| warming * (length / mean - 1.0));
        Some(vec![warming.clone(), beyond.collect()])
    }

    /// The distance at which the first number is meant is the recording's mean.
    fn further(&self, input: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        let context = input.context;
        vec![
            amplitudes[1],
            context.mean_length_m(),
            context.reference_degc,
        ]
    }

    fn whole(&self, input: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (beyond, length_m) = (further[0], further[1]);
        let longer = input.context.mean_length_m() / length_m;
        // the same line through the distances, about another mean
        let at_mean = values[0] + beyond * (longer - 1.0);
        (vec![at_mean, beyond * longer], 0.0)
    }
}
