//! A play of total width 2b. Driven by the motor the link follows late; driven by the hand the motor does, so that
//! the link leads. Where torques are known the link is on the side that the load pushes to.

use haptical_model::transmission::loops::SMALLEST_HALF_WIDTH;

use crate::laws::{Input, Law};
use crate::signal::{play, smooth};
use crate::transmission::HOLD_THE_MOTOR;
use crate::{Family, Follows, Form, Further, Hook, Need, Parameter, Shape, Spec};

/// The play is driven by the motor, by the hand on the link, or stands where the load pushes it.
const DRIVEN_BY_MOTOR: f64 = 0.0;
const DRIVEN_BY_LINK: f64 = 1.0;
const DRIVEN_BY_LOAD: f64 = 2.0;
/// Driven by the motor, with the moment at which it is crossed read at the link; and by the link, read at the motor. A fit that
/// starts from one of the first two with the other's sign ends there.
const BY_MOTOR_AT_LINK: f64 = 3.0;
const BY_LINK_AT_MOTOR: f64 = 4.0;
/// Below this share of its root mean square a load is no load.
const FLIGHT_SHARE: f64 = 0.06;
/// Which of them: in a device file a word.
pub(crate) const DRIVEN_BY: Further = Further::usually("driven_by", DRIVEN_BY_MOTOR);

pub(crate) const SPEC: Spec = Spec {
    name: "backlash",
    meaning: "the joint does not follow its motor for a while after each reversal",
    inspect: "the tension of the cable, clamps and pins of the joint",
    confirm: HOLD_THE_MOTOR,
    adds: "play",
    source: "A4, A15, D5",
    hook: Hook::Transmission,
    form: Form::Play,
    needs: &[Need::Order],
    parameters: &[Parameter::size("width_rad", 0.0, 0.1)],
    further: &[DRIVEN_BY],
    shape: Shape::Sides,
    follows: Follows::Angle,
    ..Spec::of(Family::Loop)
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
        if shape != DRIVEN_BY_LINK {
            return Some(vec![play(input.reading()?, half_width, runs)]);
        }
        // without an encoder on the link its motor says where it is, to the play's width
        let lost = match input.output() {
            Some(output) => play(&smooth(output, 2, runs), half_width, runs),
            None => play(input.reading()?, half_width, runs),
        };
        Some(vec![lost.into_iter().map(|value| -value).collect()])
    }

    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let mut shapes = vec![DRIVEN_BY_MOTOR];
        shapes.extend(input.has_output().then_some(DRIVEN_BY_LINK));
        Some(shapes)
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        // no side says that a load pushes the wrong way
        let half_width = match shape == DRIVEN_BY_LOAD {
            true => amplitudes[0],
            false => amplitudes[0].abs(),
        };
        vec![2.0 * half_width]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![0.5 * values[0]], DRIVEN_BY_MOTOR)
    }

    /// A width has no sign: the side that drives has it.
    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let is_turned = amplitudes[0] < 0.0;
        let side = if is_turned && shape == DRIVEN_BY_MOTOR {
            BY_LINK_AT_MOTOR
        } else if is_turned && shape == DRIVEN_BY_LINK {
            BY_MOTOR_AT_LINK
        } else {
            shape
        };
        vec![side]
    }

    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (half_width, side) = (0.5 * values[0], further[0]);
        if side == BY_MOTOR_AT_LINK {
            (vec![-half_width], DRIVEN_BY_LINK)
        } else if side == BY_LINK_AT_MOTOR {
            (vec![-half_width], DRIVEN_BY_MOTOR)
        } else {
            (vec![half_width], side)
        }
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

    /// Every side with either sign comes back from the numbers of a file.
    #[test]
    fn a_side_has_the_sign() {
        let device = haptical_model::Device::from_toml("[[joint]]\n", "one.toml").unwrap();
        let recording = haptical_model::Recording {
            line: vec![2],
            joint: vec![vec![0.0]],
            output: vec![None],
            torque_nm: vec![None],
            ..Default::default()
        };
        let context = crate::Context::new(&device.device, &recording, &[]).unwrap();
        let play = crate::laws::Placed {
            spec: &SPEC,
            joint: Some(0),
            law: LAW,
        };
        for shape in [DRIVEN_BY_MOTOR, DRIVEN_BY_LINK, DRIVEN_BY_LOAD] {
            for half_width in [3e-4, -3e-4] {
                let given = (vec![half_width], shape);
                let values = crate::Effect::values(&play, &context, &given.0, shape);
                let further = crate::Effect::further(&play, &context, &given.0, shape);
                let again = crate::Effect::whole(&play, &context, &values, &further);
                assert_eq!(again, given);
                assert!(values[0] > 0.0 || shape == DRIVEN_BY_LOAD);
            }
        }
    }

    /// A motor that pushes forward is ahead of its link, and where hardly anything pushes the link may be anywhere.
    #[test]
    fn a_load_holds_the_link_on_its_side() {
        let side = by_load(&[100.0, -100.0, 3.0, 0.0, 100.0]);
        assert_eq!([side[0], side[1], side[3], side[4]], [-1.0, 1.0, 0.0, -1.0]);
        assert!(side[2] < -0.1 && side[2] > -0.9, "{side:?}");
        assert_eq!(by_load(&[0.0, 0.0]), [0.0, 0.0]);
    }
}
