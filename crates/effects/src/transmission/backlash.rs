//! A play of total width 2b. Driven by the motor the link follows late; driven by the hand the motor does, so that
//! the link leads.

use haptical_model::transmission::loops::SMALLEST_HALF_WIDTH;

use crate::laws::{Input, Law};
use crate::signal::{play, smooth};
use crate::{Family, Follows, Further, Hook, LawError, Need, Parameter, Shape, Spec};

/// The play is driven by the motor, or by the hand on the link.
const DRIVEN_BY_MOTOR: f64 = 0.0;
const DRIVEN_BY_LINK: f64 = 1.0;
/// Which of them: in a device file a word.
pub(crate) const DRIVEN_BY: Further = Further::usually("driven_by", DRIVEN_BY_MOTOR);

pub(crate) const SPEC: Spec = Spec {
    name: "backlash",
    meaning: "the joint does not follow its motor for a while after each reversal",
    inspect: "the tension of the cable, clamps and pins of the joint",
    adds: "play",
    source: "A4, A15, D5",
    hook: Hook::Transmission,
    family: Family::Loop,
    needs: &[Need::Order],
    parameters: &[Parameter::size("width_rad", 0.0, 0.1)],
    further: &[DRIVEN_BY],
    shape: Shape::Sides,
    follows: Follows::Angle,
    law_error: LawError::LOOP,
    ..Spec::COMMON
};

pub(crate) const LAW: Backlash = Backlash;

#[derive(Debug)]
pub(crate) struct Backlash;

impl Law for Backlash {
    fn columns(
        &self,
        input: Input<'_, '_>,
        amplitudes: &[f64],
        shape: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let half_width = amplitudes.first().map_or(0.0, |b| b.abs());
        let half_width = half_width.max(SMALLEST_HALF_WIDTH);
        let runs = &input.context.runs;
        Some(vec![
            match input.output().filter(|_| shape == DRIVEN_BY_LINK) {
                Some(output) => {
                    let lost = play(&smooth(output, 2, runs), half_width, runs);
                    lost.into_iter().map(|value| -value).collect()
                }
                None => play(input.reading()?, half_width, runs),
            },
        ])
    }

    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let mut shapes = vec![DRIVEN_BY_MOTOR];
        shapes.extend(input.has_output().then_some(DRIVEN_BY_LINK));
        Some(shapes)
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![2.0 * amplitudes[0].abs()]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![0.5 * values[0]], DRIVEN_BY_MOTOR)
    }

    fn further(&self, _: Input<'_, '_>, _: &[f64], shape: f64) -> Vec<f64> {
        vec![shape]
    }

    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (vec![0.5 * values[0]], further[0])
    }
}
