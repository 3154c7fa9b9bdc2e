//! The drum on which the measuring cable is wound is eccentric: one period per turn, and a constant, because the
//! reading was set where the drum had turned already.

use crate::context::Context;
use crate::laws::{from_polar, polar, waves};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The measuring drum turns off its centre.
pub const SPEC: Spec = Spec {
    name: "cable-drum-eccentricity",
    meaning: "the measuring drum turns off its centre",
    inspect: "the drum's run-out",
    adds: "A cos(L / R_d - phase) + what the zero was set at",
    source: "C6",
    hook: Hook::CableSensor,
    family: Family::Shape,
    needs: &[Need::Cable, Need::DrumRadius],
    parameters: &[
        Parameter::size("amplitude_m", Unit::Metre, 0.0, 5e-3),
        Parameter::phase(),
    ],
    amplitudes: 3,
    shape: Shape::Given,
    follows: Follows::Length,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct DrumEccentricity;

impl Effect for DrumEccentricity {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let cable = context.device.cables.first();
        let radius_m = cable.and_then(|cable| cable.drum_radius_m);
        radius_m.into_iter().collect()
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        let turns: Vec<f64> = cable.length_m.iter().map(|length| length / shape).collect();
        let [cosines, sines] = waves(&turns, 1.0);
        vec![
            context.cable_error(cosines),
            context.cable_error(sines),
            context.cable_error(vec![1.0; context.rows()]),
        ]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        polar(amplitudes)
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let mut amplitudes = from_polar(values);
        amplitudes.push(0.0);
        let shape = self.shapes(context).first().copied().unwrap_or(0.015);
        (amplitudes, shape)
    }

    /// The constant is the turn at the zero: no larger than the amplitude, its own uncertainty allowed for.
    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        amplitudes[2].abs() <= 2.5 * amplitudes[0].hypot(amplitudes[1])
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
