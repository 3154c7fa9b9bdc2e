//! What may have changed instead of the device, in an earlier model (docs/diagnosis.md, "Earlier model"): its tool, or a sensor's place.

use std::collections::BTreeMap;

use haptical_effects::device::with_variances;
use haptical_effects::{Effect, Family, Stream, catalogue};
use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, Evaluation};
use nalgebra::DMatrix;

use crate::answer::ParameterAnswer;
use crate::engine::{Columns, Engine};

/// Whitened columns of a shift along each axis of the handle's frame, as the earlier model turns it; none where
/// nothing shows the handle.
pub(crate) fn tool_columns(engine: &Engine<'_>, earlier: &Device) -> Option<Vec<Vec<f64>>> {
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
        engine.whole.blocks.dense(&context.handle(moved))
    });
    Some(columns.collect())
}

/// The shift in the handle's frame that explains the difference best with `given` columns free, `shift_m` and its parts. What it leaves
/// counts as noise in the intervals, and so do the errors of the earlier model's `other` numbers, which are taken to be those of a fit to
/// this recording.
pub(crate) fn shift(
    columns: &Columns,
    given: &[usize],
    tool: &[usize],
    other: &[usize],
) -> Option<BTreeMap<String, ParameterAnswer>> {
    let chosen: Vec<usize> = given.iter().chain(tool).copied().collect();
    let (values, covariance) = columns.solution(&chosen, other);
    let parts: Vec<f64> = values[given.len()..].to_vec();
    let size = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let entry = |a: usize, b: usize| covariance[(given.len() + a, given.len() + b)];
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
    Some(parameters)
}

/// A sensor that is elsewhere throughout the recording.
#[derive(Debug)]
pub(crate) struct Displaced {
    pub(crate) effect: Box<dyn Effect>,
    /// Whitened columns of its amplitudes.
    pub(crate) columns: Vec<Vec<f64>>,
}

/// Every sensor whose place the recording shows. An effect that places differ from a run on does so from the first.
pub(crate) fn displaced(engine: &Engine<'_>) -> Vec<Displaced> {
    let context = &engine.context;
    let places = catalogue(context.device).into_iter();
    let places = places.filter(|effect| effect.spec().family == Family::Place);
    let with_columns = places.map(|effect| {
        let nothing = vec![0.0; effect.spec().amplitudes];
        let signals = effect.derivative(context, &nothing, 0.0);
        let columns = signals.iter().map(|own| engine.whole.blocks.dense(own));
        Displaced {
            columns: columns.collect(),
            effect,
        }
    });
    let is_shown = |column: &Vec<f64>| column.iter().any(|entry| *entry != 0.0);
    with_columns
        .filter(|displaced| displaced.columns.iter().all(is_shown))
        .collect()
}

impl Displaced {
    /// Its reported numbers with intervals, by the delta method.
    pub(crate) fn parameters(
        &self,
        engine: &Engine<'_>,
        amplitudes: &[f64],
        covariance: &DMatrix<f64>,
    ) -> BTreeMap<String, ParameterAnswer> {
        let context = &engine.context;
        let values = with_variances(self.effect.as_ref(), context, amplitudes, 0.0, covariance);
        let pairs = self.effect.spec().parameters.iter().zip(values);
        pairs
            .map(|(spec, (value, variance))| {
                let sd = variance.max(0.0).sqrt();
                (spec.name.to_owned(), ParameterAnswer::normal(value, sd))
            })
            .collect()
    }
}
