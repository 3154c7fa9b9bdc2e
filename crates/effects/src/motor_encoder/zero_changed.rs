//! A motor encoder counts from another place between two runs, as after a new homing: by its offset the joint's readings are
//! too low from there on.

use crate::laws::{FROM_RUN, Input, Law, first_row, run_of};
use crate::{Family, Follows, Form, Hook, Need, Parameter, Shape, Spec};

/// The zero of a joint that turns is not the same in all runs.
pub const SPEC: Spec = Spec {
    name: "zero-changed",
    meaning: "the joint's zero is not the same in all runs",
    inspect: "the homing of that joint, and what was taken apart between the runs",
    adds: "a constant, from a run on",
    hook: Hook::Transmission,
    form: Form::Step,
    needs: &[Need::Runs],
    parameters: &[Parameter::size("offset_rad", 0.0, 1.0)],
    further: &[FROM_RUN],
    shape: Shape::Given,
    follows: Follows::Run,
    ..Spec::of(Family::Step)
};

/// The zero of a slide.
pub(crate) const OF_SLIDE: Spec = Spec {
    parameters: &[Parameter::size("offset_m", 0.0, 1.0)],
    ..SPEC
};

pub(crate) const LAW: ZeroChanged = ZeroChanged;

#[derive(Debug)]
pub(crate) struct ZeroChanged;

impl Law for ZeroChanged {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let first = first_row(input, shape);
        let rows = 0..input.context.rows();
        Some(vec![
            rows.map(|row| f64::from(u8::from(row >= first))).collect(),
        ])
    }

    fn further(&self, _: Input<'_, '_>, _: &[f64], shape: f64) -> Vec<f64> {
        vec![shape + 1.0]
    }

    fn whole(&self, input: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], run_of(input, further[0]))
    }
}
