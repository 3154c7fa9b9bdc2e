//! A joint is turned by another one through the routing of its cable; one of many pairs.

use crate::laws::{Input, Law};
use crate::{Family, Follows, Form, Hook, Parameter, Shape, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cross-coupling",
    meaning: "one joint moves or loads another: a cable, shaft or differential passes it",
    inspect: "cables, pulleys, shafts and differentials of one joint that pass the other",
    confirm: "to confirm {name}: hold the loaded joint still and let the other one press against a stop, both ways; its drive \
              answers in proportion",
    adds: "kappa theta_from",
    source: "A13",
    hook: Hook::Transmission,
    form: Form::Coupling,
    parameters: &[
        Parameter::size("gain", 0.0, 0.5),
        Parameter::number("from_joint", 1000.0),
    ],
    shape: Shape::Given,
    follows: Follows::OtherAngle,
    log_prior: -1.0,
    ..Spec::of(Family::Coupling)
};

#[derive(Debug)]
pub(crate) struct CrossCoupling {
    /// The other joint.
    pub(crate) from: usize,
}

impl Law for CrossCoupling {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![input.context.recording.joint.get(self.from)?.clone()])
    }

    fn other_joint(&self) -> Option<usize> {
        Some(self.from)
    }

    fn shapes(&self, _: Input<'_, '_>) -> Option<Vec<f64>> {
        Some(vec![(self.from + 1) as f64])
    }
}
