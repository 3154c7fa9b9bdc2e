//! A cos(k x - phase), as a cos(k x) + b sin(k x).

use crate::laws::{Input, Law};
use crate::{Family, Follows, Form, Parameter, Shape, Spec};

/// A harmonic of a joint's angle: its shape is 1, or the order that is searched, which is a parameter then.
#[derive(Debug)]
pub(crate) struct Harmonic;

impl Harmonic {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Harmonic(Some(1.0)),
        parameters: &[
            Parameter::size("amplitude_rad", 0.0, 0.1),
            Parameter::phase(),
        ],
        amplitudes: 2,
        shape: Shape::Listed(&[1.0]),
        follows: Follows::Angle,
        ..Spec::of(Family::Shape)
    };
}

impl Law for Harmonic {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let Form::Harmonic(periods) = input.spec.form else {
            return None;
        };
        let periods = periods.unwrap_or(shape * input.joint()?.transmission_ratio);
        Some(waves(input.reading()?, periods).to_vec())
    }

    fn values(&self, input: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let mut values = [polar(amplitudes), vec![shape]].concat();
        values.truncate(input.spec.parameters.len());
        values
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (from_polar(values), values.get(2).copied().unwrap_or(1.0))
    }
}

/// cos(k x) and sin(k x).
pub(crate) fn waves(angle: &[f64], order: f64) -> [Vec<f64>; 2] {
    let (sines, cosines) = angle.iter().map(|q| (order * q).sin_cos()).unzip();
    [cosines, sines]
}

/// A and phase of a and b.
pub(crate) fn polar(amplitudes: &[f64]) -> Vec<f64> {
    vec![
        amplitudes[0].hypot(amplitudes[1]),
        amplitudes[1].atan2(amplitudes[0]),
    ]
}

/// a and b of A and phase.
pub(crate) fn from_polar(values: &[f64]) -> Vec<f64> {
    let (sin, cos) = values[1].sin_cos();
    vec![values[0] * cos, values[0] * sin]
}
