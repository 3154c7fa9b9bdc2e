//! The axis of a joint tilts with its own angle, about two axes across it that stand still in the link before.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The axis of a joint tilts as it turns.
pub const SPEC: Spec = Spec {
    name: "axis-wobble",
    meaning: "the axis of a joint tilts as it turns",
    inspect: "the bearings of that joint",
    adds: "see above",
    source: "D3",
    hook: Hook::Structure,
    family: Family::Wobble,
    needs: &[Need::Chain],
    parameters: &[
        Parameter::size("amplitude_rad", Unit::Radian, 0.0, 2e-2),
        Parameter::phase(),
        Parameter::number("order", 100.0),
    ],
    amplitudes: 4,
    shape: Shape::Listed(&[1.0, 2.0]),
    follows: Follows::Angle,
    log_prior: -1.0,
    law_error: LawError::RIGID,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct AxisWobble {
    pub(crate) joint: usize,
}

impl AxisWobble {
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

impl Effect for AxisWobble {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
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
}

#[cfg(test)]
crate::conforms!(SPEC);
