//! Courses of slow changes.

use crate::context::Context;
use crate::laws::{Input, Law};
use crate::{Family, Form, Further, Parameter, Shape, Spec};

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

/// Length of the longest run \[s\].
fn whole_s(context: &Context<'_>) -> f64 {
    let elapsed_s = context.elapsed_s().unwrap_or_default();
    elapsed_s.into_iter().fold(0.0, f64::max).max(1e-9)
}

/// How far a drift of rate 1 comes within a time, that settles with a time constant; steadily where that is 0.
fn reached(time_s: f64, time_constant_s: f64) -> f64 {
    match time_constant_s > 0.0 {
        true => 1.0 - (-time_s / time_constant_s).exp(),
        false => time_s,
    }
}

/// A drift in time; its shape is the course.
#[derive(Debug)]
pub(crate) struct Drift;

impl Drift {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Drift,
        parameters: &[Parameter::size("rad_per_s", 0.0, 5e-4)],
        further: &[
            Further::usually("time_constant_s", 0.0),
            Further::usually("over_s", 0.0),
        ],
        shape: Shape::Listed(&[0.0, 1.0, 0.3, 0.1]),
        ..Spec::of(Family::Drift)
    };
}

impl Law for Drift {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![course(input.context, shape)])
    }

    /// The time constant of a drift that settles, and the time over which the rate is its mean.
    fn further(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Vec<f64> {
        let whole_s = whole_s(input.context);
        match shape > 0.0 {
            true => vec![shape * whole_s, whole_s],
            false => vec![0.0, 0.0],
        }
    }

    /// On a recording of another length the mean rate is another one.
    fn whole(&self, input: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (constant_s, over_s) = (further[0], further[1]);
        if constant_s <= 0.0 || over_s <= 0.0 {
            return (vec![values[0]], 0.0);
        }
        let whole_s = whole_s(input.context);
        let end = values[0] * over_s / reached(over_s, constant_s);
        let mean_rate = end * reached(whole_s, constant_s) / whole_s;
        (vec![mean_rate], constant_s / whole_s)
    }
}
