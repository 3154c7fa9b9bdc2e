//! A part that yields by torque over stiffness, reported as the stiffness.

use crate::laws::{Input, Law};
use crate::{Family, Follows, Form, Parameter, Spec};

/// -tau / k.
#[derive(Debug)]
pub(crate) struct Spring;

impl Spring {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Spring,
        parameters: &[Parameter::inverse("stiffness_nm_per_rad", 20.0, 1e9)],
        follows: Follows::Torque,
        is_positive: true,
        scales_with_torque: true,
        ..Spec::of(Family::Load)
    };
}

impl Law for Spring {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let torque_nm = input.torque_nm()?.iter();
        Some(vec![torque_nm.map(|torque| -torque).collect()])
    }
}
