//! Test for another tool: does it explain all that an earlier model gets wrong (docs/diagnosis.md, "Earlier model")?

use std::collections::BTreeMap;

use haptical_effects::Stream;
use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, Evaluation};

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::engine::least::Columns;
use crate::engine::part::dense;

/// A shift of the handle in its own frame.
#[derive(Debug, Clone)]
pub(crate) struct Shift {
    /// `shift_m`, and its parts along the handle's axes.
    pub(crate) parameters: BTreeMap<String, ParameterAnswer>,
}

/// Whitened columns of a shift along each axis of the handle's frame, as the earlier model turns it; none where
/// nothing shows the handle.
pub(crate) fn columns(engine: &Engine<'_>, earlier: &Device) -> Option<Vec<Vec<f64>>> {
    let context = &engine.context;
    if !context.streams.iter().any(Stream::shows_handle) {
        return None;
    }
    let mut evaluation = Evaluation::new(earlier);
    let mut readings = vec![0.0; earlier.joints.len()];
    let rotation: Option<Vec<Matrix3<f64>>> = (0..context.rows())
        .map(|row| {
            context.recording.read_joints(row, &mut readings);
            evaluation.choose_hand(earlier.hand_at(context.recording, row));
            evaluation.move_pose_to(&readings).ok()?;
            evaluation.pose().ok().map(|pose| pose.rotation)
        })
        .collect();
    let rotation = rotation?;
    let columns = (0..3).map(|axis| {
        let moved = |row: usize| (rotation[row].column(axis).into_owned(), Default::default());
        dense(&engine.whole, &context.handle(moved))
    });
    Some(columns.collect())
}

/// The shift that explains the difference best with `given` columns free. What it leaves counts as noise in the
/// intervals, and so do the errors of the earlier model's `other` numbers, which are taken to be those of a fit to
/// this recording.
pub(crate) fn shift(
    columns: &Columns,
    given: &[usize],
    tool: &[usize],
    other: &[usize],
) -> Option<Shift> {
    let chosen: Vec<usize> = given.iter().chain(tool).copied().collect();
    let (values, covariance) = columns.solution(&chosen);
    let parts: Vec<f64> = values[given.len()..].to_vec();
    let size = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let earlier = columns.covariance_given(&chosen, other);
    let entry = |a: usize, b: usize| {
        let place = (given.len() + a, given.len() + b);
        covariance[place] + earlier[place]
    };
    let mut variance = 0.0;
    for a in 0..parts.len() {
        for b in 0..parts.len() {
            variance += parts[a] * parts[b] * entry(a, b) / (size * size).max(1e-300);
        }
    }
    let answer =
        |value: f64, variance: f64| ParameterAnswer::normal(value, variance.max(0.0).sqrt());
    let mut parameters = BTreeMap::from([("shift_m".to_owned(), answer(size, variance))]);
    for (axis, name) in ["shift_x_m", "shift_y_m", "shift_z_m"].iter().enumerate() {
        let part = answer(parts.get(axis).copied()?, entry(axis, axis));
        parameters.insert((*name).to_owned(), part);
    }
    Some(Shift { parameters })
}
