//! A play of total width 2b. Driven by the motor the link follows late; driven by the hand the motor does, so that
//! the link leads.

use crate::context::Context;
use crate::signal::{play, smooth};
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The play is driven by the motor, or by the hand on the link.
const DRIVEN_BY_MOTOR: f64 = 0.0;
const DRIVEN_BY_LINK: f64 = 1.0;

/// Half-width at which the score scan linearises: small against any motion \[rad\].
const SMALL_PLAY: f64 = 5e-5;

/// The joint does not follow its motor for a while after each reversal.
pub const SPEC: Spec = Spec {
    name: "backlash",
    meaning: "the joint does not follow its motor for a while after each reversal",
    inspect: "the tension of the cable, clamps and pins of the joint",
    adds: "play",
    source: "A4, A15, D5",
    hook: Hook::Transmission,
    family: Family::Loop,
    needs: &[Need::Motion],
    parameters: &[Parameter::size("width_rad", Unit::Radian, 0.0, 0.1)],
    shape: Shape::Sides,
    follows: Follows::Angle,
    law_error: LawError::LOOP,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct Backlash {
    pub(crate) joint: usize,
}

impl Backlash {
    fn lost(&self, context: &Context<'_>, half_width: f64, shape: f64) -> Vec<f64> {
        let readings = &context.recording.joint[self.joint];
        let output = context.recording.output.get(self.joint);
        match output.and_then(Option::as_ref) {
            Some(output) if shape == DRIVEN_BY_LINK => {
                let output = smooth(output, 2, &context.runs);
                let lost = play(&output, half_width, &context.runs);
                lost.into_iter().map(|value| -value).collect()
            }
            _ => play(readings, half_width, &context.runs),
        }
    }
}

impl Effect for Backlash {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        if context.output_stream(self.joint).is_some() {
            vec![DRIVEN_BY_MOTOR, DRIVEN_BY_LINK]
        } else {
            vec![DRIVEN_BY_MOTOR]
        }
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal> {
        let half_width = amplitudes.first().map_or(0.0, |b| b.abs()).max(SMALL_PLAY);
        vec![context.upstream(self.joint, &self.lost(context, half_width, shape))]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![2.0 * amplitudes[0].abs()]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![0.5 * values[0]], DRIVEN_BY_MOTOR)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
