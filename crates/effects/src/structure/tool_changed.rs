//! The handle moved in its own frame between two runs, or against an earlier model.

use nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The last link or the handle is not the same in all runs, or not the earlier model's.
pub const SPEC: Spec = Spec {
    name: "tool-changed",
    meaning: "the last link or the handle is not the same in all runs, or not the earlier model's",
    inspect: "the handle and its fastening, now and before",
    adds: "a shift in the handle's frame, from a run on or against an earlier model",
    hook: Hook::Structure,
    family: Family::Tool,
    needs: &[Need::Chain, Need::Runs],
    parameters: &[Parameter::size("shift_m", Unit::Metre, 0.0, 1.0)],
    amplitudes: 3,
    shape: Shape::Given,
    follows: Follows::Run,
    law_error: LawError::RIGID,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct ToolChanged;

impl Effect for ToolChanged {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        (1..context.runs.len().min(9))
            .map(|run| run as f64)
            .collect()
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let first = context
            .runs
            .get(shape as usize)
            .map_or(usize::MAX, |run| run.start);
        (0..3)
            .map(|axis| {
                context.handle(|row| {
                    let moved = if row < first {
                        Vector3::zeros()
                    } else {
                        context.rotation[row].column(axis).into_owned()
                    };
                    (moved, Vector3::zeros())
                })
            })
            .collect()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes.iter().map(|a| a * a).sum::<f64>().sqrt()]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0], 0.0, 0.0], 1.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
