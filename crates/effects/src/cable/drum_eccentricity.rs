//! The drum on which the measuring cable is wound is eccentric: one period per turn, and a constant, because the
//! reading was set where the drum had turned already.

use crate::laws::{Input, Law, from_polar, polar, waves};
use crate::{Family, Follows, Further, Hook, Need, Parameter, Shape, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-drum-eccentricity",
    meaning: "the measuring drum turns off its centre",
    inspect: "the drum's run-out",
    adds: "A cos(L / R_d - phase) + what the zero was set at",
    source: "C6",
    hook: Hook::CableSensor,
    needs: &[Need::Cable, Need::DrumRadius],
    parameters: &[
        Parameter::size("amplitude_m", 0.0, 5e-3),
        Parameter::phase(),
    ],
    further: &[Further::usually("constant_m", 0.0)],
    amplitudes: 3,
    shape: Shape::Given,
    follows: Follows::Length,
    ..Spec::of(Family::Shape)
};

pub(crate) const LAW: DrumEccentricity = DrumEccentricity;

#[derive(Debug)]
pub(crate) struct DrumEccentricity;

impl Law for DrumEccentricity {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let turns: Vec<f64> = input
            .reading()?
            .iter()
            .map(|length| length / shape)
            .collect();
        let [cosines, sines] = waves(&turns, 1.0);
        Some(vec![cosines, sines, vec![1.0; turns.len()]])
    }

    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let cable = input.context.device.cables.first();
        let radius_m = cable.and_then(|cable| cable.drum_radius_m);
        Some(radius_m.into_iter().collect())
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        polar(amplitudes)
    }

    fn amplitudes(&self, input: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        let radius_m = self.shapes(input).unwrap_or_default();
        (
            from_polar(values),
            radius_m.first().copied().unwrap_or(0.015),
        )
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[2]]
    }

    fn whole(&self, input: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (mut amplitudes, radius_m) = self.amplitudes(input, values);
        amplitudes.push(further[0]);
        (amplitudes, radius_m)
    }

    /// The constant is the turn at the zero: no larger than the amplitude, its own uncertainty allowed for.
    fn is_possible(&self, _: Input<'_, '_>, amplitudes: &[f64]) -> bool {
        amplitudes[2].abs() <= 2.5 * amplitudes[0].hypot(amplitudes[1])
    }
}
