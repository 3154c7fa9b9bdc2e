//! A channel that shows what was true a delay ago: x(t - delay) - x(t), to second order. The first order alone
//! leaves, at 4 ms and the accelerations of a hand, more than the noise of a cable encoder.

use haptical_model::transmission::loops::delayed;

use crate::laws::{Input, Law};
use crate::signal::LocalMotion;
use crate::{Family, Follows, Form, Parameter, Spec};

/// -delay v + delay^2 a / 2.
pub(crate) fn moved(motion: &LocalMotion, delay_s: f64) -> Vec<f64> {
    let pairs = motion.velocity.iter().zip(&motion.acceleration);
    pairs.map(|(v, a)| delayed(delay_s, *v, *a)).collect()
}

/// Its derivative with respect to the delay.
pub(crate) fn slope(motion: &LocalMotion, delay_s: f64) -> Vec<f64> {
    let pairs = motion.velocity.iter().zip(&motion.acceleration);
    pairs.map(|(v, a)| delay_s * a - v).collect()
}

/// A reading that is taken late.
#[derive(Debug)]
pub(crate) struct Delay;

impl Delay {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Delay,
        parameters: &[Parameter::size("delay_s", 0.0, 0.05)],
        follows: Follows::Speed,
        ..Spec::of(Family::Lag)
    };
}

impl Law for Delay {
    fn columns(&self, input: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![slope(input.motion()?, amplitudes[0])])
    }

    fn error(&self, input: Input<'_, '_>, amplitudes: &[f64]) -> Option<Vec<f64>> {
        Some(moved(input.motion()?, amplitudes[0]))
    }
}
