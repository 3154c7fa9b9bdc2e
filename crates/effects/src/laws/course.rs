//! Courses of slow changes.

use crate::context::Context;
use crate::laws::{Input, Law};
use crate::{Family, LawError, Parameter, Shape, Spec};

/// Time since the start of the run \[s\]; of a drift that settles, scaled to the slope of a steady one with the
/// same end.
fn course(context: &Context<'_>, shape: f64) -> Vec<f64> {
    let Some(elapsed_s) = context.elapsed_s() else {
        return vec![0.0; context.rows()];
    };
    let whole = elapsed_s.iter().copied().fold(0.0, f64::max).max(1e-9);
    if shape == 0.0 {
        return elapsed_s;
    }
    let end = 1.0 - (-1.0 / shape).exp();
    elapsed_s
        .into_iter()
        .map(|time| whole * (1.0 - (-time / (shape * whole)).exp()) / end)
        .collect()
}

/// A drift in time; its shape is the course.
#[derive(Debug)]
pub(crate) struct Drift;

impl Drift {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        family: Family::Drift,
        parameters: &[Parameter::size("rad_per_s", 0.0, 5e-4)],
        shape: Shape::Listed(&[0.0, 1.0, 0.3, 0.1]),
        law_error: LawError::DRIFT,
        ..Spec::COMMON
    };
}

impl Law for Drift {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![course(input.context, shape)])
    }
}
