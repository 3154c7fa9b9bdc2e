//! The handle moved in its own frame between two runs, or against an earlier model.

use nalgebra::Vector3;

use crate::laws::{FROM_RUN, Input, Law, first_row, run_of};
use crate::structure::norm;
use crate::{Family, Follows, Form, Further, Hook, Need, Parameter, Shape, Signal, Spec};

/// The last link or the handle is not the same in all runs, or not the earlier model's.
pub const SPEC: Spec = Spec {
    name: "tool-changed",
    meaning: "the last link or the handle is not the same in all runs, or not the earlier model's",
    inspect: "the handle and its fastening, now and before",
    adds: "a shift in the handle's frame, from a run on or against an earlier model",
    hook: Hook::Structure,
    form: Form::Shift,
    needs: &[Need::Chain, Need::Runs],
    parameters: &[Parameter::size("shift_m", 0.0, 1.0)],
    further: &[
        Further::needed("x_m"),
        Further::needed("y_m"),
        Further::needed("z_m"),
        FROM_RUN,
    ],
    amplitudes: 3,
    shape: Shape::Given,
    follows: Follows::Run,
    ..Spec::of(Family::Tool)
};

pub(crate) const LAW: ToolChanged = ToolChanged;

#[derive(Debug)]
pub(crate) struct ToolChanged;

impl Law for ToolChanged {
    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        let (context, first) = (input.context, first_row(input, shape));
        let still = (Vector3::zeros(), Vector3::zeros());
        let along = |axis: usize| {
            let moved = |row: usize| context.rotation[row].column(axis).into_owned();
            context.handle(|row| {
                if row < first {
                    still
                } else {
                    (moved(row), Vector3::zeros())
                }
            })
        };
        Some((0..3).map(along).collect())
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![norm(amplitudes)]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], 1.0)
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [amplitudes, &[shape + 1.0]].concat()
    }

    fn whole(&self, input: Input<'_, '_>, _: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (further[..3].to_vec(), run_of(input, further[3]))
    }
}
