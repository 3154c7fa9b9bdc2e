//! A loop that turns over at each reversal within a travel (Dahl 1968): the shape is that travel.

use crate::laws::{Input, Law};
use crate::signal::dahl;
use crate::{Family, Follows, Form, Further, Parameter, Shape, Spec};

/// Whether what is measured runs ahead of the motor after a reversal (driven by the hand: 1) or stays behind (driven by the
/// motor: 0).
pub(crate) const AHEAD: Further = Further::usually("driven_by", 0.0);

/// [`AHEAD`] of an amplitude.
pub(crate) fn ahead(amplitudes: &[f64]) -> f64 {
    f64::from(u8::from(amplitudes[0] > 0.0))
}

/// The amplitude of a size on the side that [`AHEAD`] says.
pub(crate) fn signed(size: f64, ahead: f64) -> f64 {
    if ahead > 0.0 { size } else { -size }
}

/// Dahl's loop of a joint's angle by its transmission: a reading of a drive whose ratio is 5 % off would make the travel
/// 5 % too long.
#[derive(Debug)]
pub(crate) struct Reversal;

impl Reversal {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Loop,
        parameters: &[
            Parameter::size("amplitude_rad", 0.0, 0.1),
            Parameter::transition("transition_rad", 5.0),
        ],
        further: &[AHEAD],
        shape: Shape::Continuous(&[3e-4, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0]),
        follows: Follows::Angle,
        log_prior: -0.5,
        ..Spec::of(Family::Loop)
    };
}

impl Law for Reversal {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let travel = input.context.output.get(input.joint?)?;
        Some(vec![dahl(travel, shape, &input.context.runs)])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0].abs(), shape]
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![ahead(amplitudes)]
    }

    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (vec![signed(values[0], further[0])], values[1])
    }
}
