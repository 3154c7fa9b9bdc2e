//! A joint shows the play of another joint's cable, which runs over it; one of many pairs.

use crate::laws::{Input, Law};
use crate::signal::play;
use crate::{Family, Follows, Form, Hook, Need, Parameter, Shape, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "coupled-backlash",
    meaning: "one joint moves while the play of another one's cable is taken up",
    inspect: "the tension of the other joint's cable, which runs over this joint",
    adds: "A play(theta_from) / w",
    source: "",
    hook: Hook::Transmission,
    form: Form::CoupledPlay,
    needs: &[Need::Motion],
    parameters: &[
        Parameter::size("width_rad", 0.0, 0.1),
        Parameter::number("play_rad", 2.0),
        Parameter::number("from_joint", 1000.0),
    ],
    shape: Shape::Continuous(&[0.01, 0.03, 0.1, 0.2, 0.4]),
    follows: Follows::OtherAngle,
    is_found_beside: true,
    log_prior: -2.0,
    ..Spec::of(Family::Loop)
};

#[derive(Debug)]
pub(crate) struct CoupledBacklash {
    /// The joint whose cable has the play.
    pub(crate) from: usize,
}

impl Law for CoupledBacklash {
    /// The shape is half of the other cable's play \[rad\].
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let reading = input.context.recording.joint.get(self.from)?;
        let lost = play(reading, shape, &input.context.runs);
        Some(vec![lost.into_iter().map(|lost| lost / shape).collect()])
    }

    fn other_joint(&self) -> Option<usize> {
        Some(self.from)
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![2.0 * amplitudes[0], 2.0 * shape, (self.from + 1) as f64]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        let shape = values.get(1).map_or(0.1, |play| 0.5 * play);
        (vec![0.5 * values[0]], shape)
    }
}
