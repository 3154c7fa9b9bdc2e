//! A play of total width 2b. Driven by the motor the link follows late; driven by the hand the motor does, so that
//! the link leads. Where torques are known the link is on the side that the load pushes to.

use haptical_model::transmission::loops::SMALLEST_HALF_WIDTH;

use crate::laws::{Input, Law};
use crate::signal::{play, smooth};
use crate::{Family, Follows, Further, Hook, LawError, Need, Parameter, Shape, Spec};

/// The play is driven by the motor, by the hand on the link, or stands where the load pushes it.
const DRIVEN_BY_MOTOR: f64 = 0.0;
const DRIVEN_BY_LINK: f64 = 1.0;
const DRIVEN_BY_LOAD: f64 = 2.0;
/// Below this share of its root mean square a load is no load.
const FLIGHT_SHARE: f64 = 0.06;
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
        if shape == DRIVEN_BY_LOAD {
            return Some(vec![by_load(input.torque_nm()?)]);
        }
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

/// The link's side per half width: a load on it pulls it back from its motor.
fn by_load(torque_nm: &[f64]) -> Vec<f64> {
    let square: f64 = torque_nm.iter().map(|own| own * own).sum();
    let flight_nm = FLIGHT_SHARE * (square / torque_nm.len().max(1) as f64).sqrt();
    let side = |torque: &f64| match flight_nm > 0.0 {
        true => -(torque / flight_nm).clamp(-1.0, 1.0),
        false => 0.0,
    };
    torque_nm.iter().map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motor that pushes forward is ahead of its link, and where hardly anything pushes the link may be anywhere.
    #[test]
    fn a_load_holds_the_link_on_its_side() {
        let side = by_load(&[100.0, -100.0, 3.0, 0.0, 100.0]);
        assert_eq!([side[0], side[1], side[3], side[4]], [-1.0, 1.0, 0.0, -1.0]);
        assert!(side[2] < -0.1 && side[2] > -0.9, "{side:?}");
        assert_eq!(by_load(&[0.0, 0.0]), [0.0, 0.0]);
    }
}
