//! The axis of a joint tilts with its own angle, about two axes across it that stand still in the link before.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use crate::laws::{Input, Law};
use crate::{Context, Family, Follows, Form, Further, Hook, Need, Parameter, Shape, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "axis-wobble",
    meaning: "the axis of a joint tilts as it turns",
    inspect: "the bearings of that joint",
    adds: "see above",
    source: "D3",
    hook: Hook::Structure,
    form: Form::Wobble,
    needs: &[Need::Chain],
    parameters: &[
        Parameter::size("amplitude_rad", 0.0, 2e-2),
        Parameter::phase(),
        Parameter::number("order", 100.0),
    ],
    further: &[
        Further::usually("across_cos_rad", 0.0),
        Further::usually("across_sin_rad", 0.0),
    ],
    amplitudes: 4,
    shape: Shape::Listed(&[1.0, 2.0]),
    follows: Follows::Angle,
    log_prior: -1.0,
    ..Spec::of(Family::Wobble)
};

pub(crate) const LAW: AxisWobble = AxisWobble;

#[derive(Debug)]
pub(crate) struct AxisWobble;

/// Two unit vectors across a joint's axis that the link before it carries along (`Twist::across`).
pub(crate) fn across(context: &Context<'_>, joint: usize, row: usize) -> Option<[Vector3<f64>; 2]> {
    context.lever(joint, row)?;
    let device = context.device;
    let twist = |joint: usize| context.twist.get(joint)?.get(row);
    let parent = device.first_row(joint).and_then(|row| device.parent(row));
    let before = match parent.and_then(|row| device.drive(row)) {
        Some(drive) => Some(twist(drive.joint)?),
        None => None,
    };
    twist(joint)?.across(before)
}

impl Law for AxisWobble {
    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        let (context, joint) = (input.context, input.joint?);
        // per row: the arm, the two directions, sine and cosine
        let angles = context.output[joint].iter().enumerate();
        let rows: Vec<_> = angles
            .map(|(row, angle)| {
                let across = across(context, joint, row)?;
                let (_, arm) = context.lever(joint, row)?;
                let (sin, cos) = (shape * angle).sin_cos();
                Some((arm, across, sin, cos))
            })
            .collect();
        let column = |column: usize| {
            context.handle(|row| {
                let Some((arm, across, sin, cos)) = &rows[row] else {
                    return (Vector3::zeros(), Vector3::zeros());
                };
                let turn = across[column / 2] * if column.is_multiple_of(2) { *cos } else { *sin };
                (turn.cross(arm), turn)
            })
        };
        Some((0..4).map(column).collect())
    }

    /// The largest tilt and where in the turn it is: the long axis of the ellipse that a cos + b sin
    /// describes.
    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let a = Vector2::new(amplitudes[0], amplitudes[2]);
        let b = Vector2::new(amplitudes[1], amplitudes[3]);
        let phase = 0.5 * (2.0 * a.dot(&b)).atan2(a.norm_squared() - b.norm_squared());
        let tilt = a * phase.cos() + b * phase.sin();
        // of two opposite places the one with the tilt along the first direction
        let phase = if tilt.x < 0.0 { phase + PI } else { phase };
        vec![tilt.norm(), phase.sin().atan2(phase.cos()), shape]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        let (sin, cos) = values[1].sin_cos();
        (vec![values[0] * cos, values[0] * sin], values[2])
    }

    /// What of the ellipse amplitude and phase do not say: the tilts about the second direction, and how the long axis lies.
    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[2], amplitudes[3]]
    }

    /// Tilts of a given size and place whose part about the second direction is known: the part about the first one is
    /// what makes the long axis so long, and there.
    fn whole(&self, _: Input<'_, '_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (sin, cos) = values[1].sin_cos();
        let along = further[0] * cos + further[1] * sin;
        let across = further[1] * cos - further[0] * sin;
        let first = (values[0] * values[0] - along * along).max(0.0).sqrt();
        // the two axes of an ellipse are at right angles
        let second = match first > 0.0 {
            true => -along * across / first,
            false => 0.0,
        };
        let amplitudes = vec![
            first * cos - second * sin,
            first * sin + second * cos,
            further[0],
            further[1],
        ];
        (amplitudes, values[2])
    }
}
