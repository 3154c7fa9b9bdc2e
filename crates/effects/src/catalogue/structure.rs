//! Effects of the structure: wobbling joint axes, a tool that was changed between runs.

use std::f64::consts::PI;

use haptical_model::kinematics::nalgebra::{Vector2, Vector3};

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::Signal;

pub(super) fn at_joint(joint: usize) -> Vec<Box<dyn Effect>> {
    vec![Box::new(Wobble { joint })]
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![Box::new(ToolChanged)]
}

/// D3: the axis tilts with its own angle, about two axes across it that stand still in the link before.
#[derive(Debug)]
struct Wobble {
    joint: usize,
}

impl Wobble {
    /// Two unit vectors across the joint's axis that the link before it carries along.
    fn across(&self, context: &Context<'_>, row: usize) -> Option<[Vector3<f64>; 2]> {
        let (axis, _) = context.lever(self.joint, row)?;
        let before = match self.joint.checked_sub(1) {
            Some(joint) => context.twist.get(joint).and_then(|twist| {
                let twist = twist.get(row)?;
                let slides = twist.angular.norm_squared() < 0.5;
                Some(if slides { twist.linear } else { twist.angular })
            }),
            // the first axis stands still: any fixed direction that is not along it
            None if axis.x.abs() < 0.9 => Some(Vector3::x()),
            None => Some(Vector3::y()),
        }?;
        let first = axis.cross(&before).try_normalize(0.05)?;
        Some([first, axis.cross(&first)])
    }
}

impl Effect for Wobble {
    fn name(&self) -> &'static str {
        "axis-wobble"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Structure
    }

    fn family(&self) -> Family {
        Family::Wobble
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const {
            &[
                parameter("amplitude_rad", 0.0, 2e-2),
                parameter("phase_rad", 0.0, 10.0),
                parameter("order", 0.0, 100.0),
            ]
        }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Chain]
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        vec![1.0, 2.0]
    }

    fn amplitude_count(&self) -> usize {
        4
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        // per row: the arm, the two directions, sine and cosine
        let rows: Vec<_> = context.output[self.joint]
            .iter()
            .enumerate()
            .map(|(row, angle)| {
                let across = self.across(context, row)?;
                let (_, arm) = context.lever(self.joint, row)?;
                let (sin, cos) = (shape * angle).sin_cos();
                Some((arm, across, sin, cos))
            })
            .collect();
        (0..4)
            .map(|column| {
                context.handle(|row| {
                    let Some((arm, across, sin, cos)) = &rows[row] else {
                        return (Vector3::zeros(), Vector3::zeros());
                    };
                    let turn = across[column / 2] * if column % 2 == 0 { *cos } else { *sin };
                    (turn.cross(arm), turn)
                })
            })
            .collect()
    }

    /// The largest tilt and where in the turn it is: the long axis of the ellipse that a cos + b sin
    /// describes.
    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let a = Vector2::new(amplitudes[0], amplitudes[2]);
        let b = Vector2::new(amplitudes[1], amplitudes[3]);
        let phase = 0.5 * (2.0 * a.dot(&b)).atan2(a.norm_squared() - b.norm_squared());
        let tilt = a * phase.cos() + b * phase.sin();
        // of two opposite places the one with the tilt along the first direction
        let phase = if tilt.x < 0.0 { phase + PI } else { phase };
        vec![tilt.norm(), phase.sin().atan2(phase.cos()), shape]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let (sin, cos) = values[1].sin_cos();
        (vec![values[0] * cos, values[0] * sin, 0.0, 0.0], values[2])
    }

    fn log_prior(&self) -> f64 {
        -1.0
    }
}

/// The handle moved in its own frame between two runs.
#[derive(Debug)]
struct ToolChanged;

impl Effect for ToolChanged {
    fn name(&self) -> &'static str {
        "tool-changed"
    }

    fn hook(&self) -> Hook {
        Hook::Structure
    }

    fn family(&self) -> Family {
        Family::Tool
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("shift_m", 0.0, 1.0)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Chain, Need::Runs]
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        (1..context.runs.len().min(9))
            .map(|run| run as f64)
            .collect()
    }

    fn amplitude_count(&self) -> usize {
        3
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
