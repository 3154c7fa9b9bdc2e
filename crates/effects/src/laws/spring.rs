//! A part that yields by torque over stiffness, reported as the stiffness.

use crate::laws::{Input, Law};
use crate::{Family, Follows, LawError, Parameter, Spec};

/// -tau / k.
#[derive(Debug)]
pub(crate) struct Spring;

impl Spring {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        family: Family::Load,
        parameters: &[Parameter::inverse("stiffness_nm_per_rad", 20.0, 1e9)],
        follows: Follows::Torque,
        is_positive: true,
        scales_with_torque: true,
        law_error: LawError::LOAD,
        ..Spec::COMMON
    };
}

impl Law for Spring {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let torque_nm = input.torque_nm()?.iter();
        Some(vec![torque_nm.map(|torque| -torque).collect()])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![1.0 / amplitudes[0]]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![1.0 / values[0]], 0.0)
    }
}
