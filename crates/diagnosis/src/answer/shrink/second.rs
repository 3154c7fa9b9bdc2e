//! A second recording predicted with the models of the first.

use haptical_calibration::{Channel, channels, with_unseen_places};
use haptical_effects::Effect;
use haptical_effects::device::attached;
use haptical_model::{Device, Recording};

use super::Shrink;
use super::reduction::{Unseen, collect};
use crate::Result;
use crate::answer::{Prediction, SECOND_RECORDING};
use crate::engine::{Base, Cause, Engine, Fit, Predicted, Prepared, nearby, placed, places};
use crate::noise::without_readings;
use crate::select::{Instants, Selection};
use crate::thresholds::answer::ZERO_SHARE;
use crate::thresholds::steps::STEP_SCORE;

/// Predicts a second recording with the models of the first. Events belong to one recording: their
/// instants and sizes are looked for in the second one.
pub(crate) fn on_second(
    selection: &Selection<'_>,
    validation: &Recording,
    earlier: Option<&Base>,
) -> Result<Shrink> {
    let rig = &selection.engine().base.device;
    let there = channels(rig, validation).unwrap_or_default();
    let is_lacking = |channel: &Channel| {
        let is_of_chain = matches!(
            channel,
            Channel::Cable { .. } | Channel::Position | Channel::Orientation
        );
        is_of_chain && !there.contains(channel)
    };
    if selection.engine().base.channels.iter().any(is_lacking) {
        // numbers of the base model would be fixed by nothing there
        return Ok(Shrink::default());
    }
    let touched = Touched::new(selection, validation)?;
    let mut warnings = Vec::new();
    let unseen = match &touched {
        Some(_) => None,
        None => with_own_places(selection.engine().base, validation, &mut warnings)?,
    };
    let first = unseen.as_ref().unwrap_or(selection.engine().base);
    let base = touched.as_ref().map_or(first, |touched| &touched.with);
    let prepared = Prepared::new(base, validation, validation)?;
    let gone = prepared.outlying();
    let cleaned = without_readings(validation, &gone);
    let second = prepared.without(&gone, &cleaned).fit(None)?;
    let effects = selection.selector.effects;
    let causes = selection.causes().iter();
    let (firsts, causes): (Vec<&Cause>, Vec<Cause>) = causes
        .filter_map(|cause| Some((cause, in_second(&second, effects, cause)?)))
        .unzip();
    let before = match (earlier, &touched) {
        (Some(model), Some(_)) => {
            let there = placed(&model.device, &base.device, validation, &base.channels)?;
            model_residual(&there, &cleaned, &second)?
        }
        (Some(model), None) => {
            let there = with_own_places(model, validation, &mut Vec::new())?;
            model_residual(there.as_ref().unwrap_or(model), &cleaned, &second)?
        }
        (None, Some(touched)) => model_residual(&touched.plain, &cleaned, &second)?,
        (None, None) => second.residual_of(effects, &selection.engine().start.model.values, &[])?,
    };
    let is_of_first = touched.is_none();
    let with = match touched {
        Some(_) => places_beside(&second, effects, &causes, &mut warnings)?,
        None => selection.refit.model.values.clone(),
    };
    let after = second.residual_of(effects, &with, &causes)?;
    let (before, after) = zeroed(&second, before, after, &mut warnings);
    // an event of the second recording was fitted to it, and so are places
    let pairs = firsts.into_iter().zip(&causes);
    let fit = Fit {
        engine: selection.engine(),
        part: &selection.engine().whole,
        effects,
        causes: pairs.filter(|(own, _)| own.times.is_empty()).collect(),
    };
    let fit = Some(&fit).filter(|_| is_of_first);
    let asked = |stream: usize, row: usize| second.usable[stream][row];
    let predicted = Predicted::new(&second, (&base.device, validation), fit, &asked);
    warnings.extend(predicted.warnings.iter().cloned());
    let rows = |stream: usize, row: usize| predicted.leverage(stream, row);
    Ok(Shrink {
        channels: collect(&second, &rows, &before, &after),
        predictions: predictions(&second, validation, (&before, &after), &predicted),
        description: SECOND_RECORDING.to_owned(),
        warnings,
    })
}

/// Residuals of a second recording with the base model of the first and with another device in its place, channel by channel.
pub(crate) fn device_on_second(
    engine: &Engine<'_>,
    validation: &Recording,
    other: &Device,
) -> Result<Vec<Unseen>> {
    let (base, values) = (engine.base, &engine.start.model.values);
    let there = |device: &Device| placed(device, &base.device, validation, &base.channels);
    let plain = there(&engine.problem.device_with(values))?;
    let with = there(other)?;
    let prepared = Prepared::new(&plain, validation, validation)?;
    let gone = prepared.outlying();
    let cleaned = without_readings(validation, &gone);
    let second = prepared.without(&gone, &cleaned).fit(None)?;
    let before = model_residual(&plain, &cleaned, &second)?;
    let after = model_residual(&with, &cleaned, &second)?;
    let (before, after) = zeroed(&second, before, after, &mut Vec::new());
    let asked = |stream: usize, row: usize| second.usable[stream][row];
    let predicted = Predicted::new(&second, (&plain.device, validation), None, &asked);
    let is_finite = |stream: usize, row: usize| {
        before[stream][row].is_finite() && after[stream][row].is_finite()
    };
    let rows = |stream: usize, row: usize| {
        let leverage = predicted.leverage(stream, row);
        leverage.filter(|_| is_finite(stream, row))
    };
    Ok(collect(&second, &rows, &before, &after))
}

/// A model with places for the runs and tools of a second recording that the first one lacks; none where it has all.
/// Its parameters are those it had.
fn with_own_places(
    base: &Base,
    validation: &Recording,
    warnings: &mut Vec<String>,
) -> Result<Option<Base>> {
    if base.device.mounts(validation).is_ok() {
        return Ok(None);
    }
    warnings.push(
        "the second recording has runs or tools that the first one lacks: their places are fitted to its own readings, with \
         the model held"
            .to_owned(),
    );
    Ok(Some(Base {
        device: with_unseen_places(&base.device, validation)?,
        ..base.clone()
    }))
}

/// The models of the first recording where the second one touches something: nobody knows its place, so its
/// places are fitted with the models held.
struct Touched {
    /// Without the causes, and with them.
    plain: Base,
    with: Base,
}

impl Touched {
    fn new(selection: &Selection<'_>, validation: &Recording) -> Result<Option<Self>> {
        if validation.contact.is_none() && validation.plane.is_none() {
            return Ok(None);
        }
        let engine = selection.engine();
        let rig = &engine.base.device;
        let channels = channels(rig, validation)?;
        let placed = |values: &[f64]| {
            let device = engine.problem.device_with(values);
            placed(&device, rig, validation, &channels)
        };
        let with = placed(&selection.refit.model.values)?;
        let parameters = places(&with.device);
        Ok(Some(Self {
            plain: placed(&engine.start.model.values)?,
            with: Base {
                free: (0..parameters.len()).collect(),
                parameters,
                ..with
            },
        }))
    }
}

/// Where the touched points and planes of a second recording are once the causes are in the model: exact in one step but for
/// known distances.
fn places_beside(
    second: &Engine<'_>,
    effects: &[Box<dyn Effect>],
    causes: &[Cause],
    warnings: &mut Vec<String>,
) -> Result<Vec<f64>> {
    let values = second.start.model.values.clone();
    let evaluate = |values: &[f64]| second.residual_of(effects, values, causes);
    let residual = evaluate(&values)?;
    let near = nearby(&second.whole, second.base, (values, residual), &evaluate)?;
    if !near.has_converged() {
        warnings.push(
            "the places that the second recording touches were not found to the end with the causes in the model: the figures \
             on it are too bad rather than too good"
                .to_owned(),
        );
    }
    Ok(near.model.values)
}

/// Residuals without the zeros of external encoders that differ from those of the first recording: where one number is most
/// of what the causes leave of an encoder, and larger than its noise. Nothing of a device moves between two recordings by a
/// constant; an incremental encoder's zero does.
fn zeroed(
    second: &Engine<'_>,
    mut before: Vec<Vec<f64>>,
    mut after: Vec<Vec<f64>>,
    warnings: &mut Vec<String>,
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    for (index, stream) in second.context.streams.iter().enumerate() {
        if !matches!(stream.channel, Channel::Output { .. }) {
            continue;
        }
        let usable = &second.usable[index];
        let Some((zero, square)) = moments(&after[index], usable) else {
            continue;
        };
        if zero.abs() <= second.floor[index] || zero * zero <= ZERO_SHARE * square {
            continue;
        }
        warnings.push(format!(
            "{} reads {zero:.3e} {} more throughout the second recording than the model of the first predicts: its zero was \
             set anew, or the model does not hold there; the figures of this channel are without it",
            stream.name(),
            stream.unit
        ));
        for residual in [&mut before[index], &mut after[index]] {
            if let Some((zero, _)) = moments(residual, usable) {
                residual.iter_mut().for_each(|value| *value -= zero);
            }
        }
    }
    (before, after)
}

/// Mean and mean square of the usable readings.
fn moments(residual: &[f64], usable: &[bool]) -> Option<(f64, f64)> {
    let rows = residual.iter().zip(usable);
    let rows = rows.filter(|(value, usable)| **usable && value.is_finite());
    let (sum, squares, count) = rows.fold((0.0, 0.0, 0.0), |(sum, squares, count), (value, _)| {
        (sum + value, squares + value * value, count + 1.0)
    });
    (count > 0.0).then(|| (sum / count, squares / count))
}

/// Residuals of a model identified earlier, stream by stream.
pub(crate) fn model_residual(
    model: &Base,
    recording: &Recording,
    engine: &Engine<'_>,
) -> Result<Vec<Vec<f64>>> {
    let weights = haptical_calibration::Weights::stated(&model.device, &model.channels);
    let streams = &engine.context.streams;
    let mut model = model.clone();
    let recording = &attached(&mut model.device, recording)?;
    let problem = crate::engine::BaseProblem::new(&model, recording, recording, streams, &weights)?;
    Ok(problem.evaluate(&problem.start(), false)?.residual)
}

fn in_second(second: &Engine<'_>, effects: &[Box<dyn Effect>], cause: &Cause) -> Option<Cause> {
    let effect = effects[cause.effect].as_ref();
    if effect.untestable(&second.context).is_some() {
        return None;
    }
    if cause.times.is_empty() {
        return Some(cause.clone());
    }
    let instants = Instants::new(&second.system, &second.context, effect, cause.effect);
    let found = instants.with_more_steps(instants.one_step()?);
    (found.score > STEP_SCORE).then(|| Cause::from(&found))
}

fn predictions(
    engine: &Engine<'_>,
    recording: &Recording,
    (before, after): (&[Vec<f64>], &[Vec<f64>]),
    predicted: &Predicted,
) -> Vec<Prediction> {
    let mut all = Vec::new();
    for (index, stream) in engine.context.streams.iter().enumerate() {
        let measured = |row: usize| match stream.channel {
            Channel::Output { joint } => recording.output[joint].as_ref().map(|c| c[row]),
            Channel::Cable { index } => recording.cable_m[index].as_ref().map(|c| c[row]),
            Channel::Position => recording.position_m.as_ref().map(|c| c[stream.axis][row]),
            // an orientation is predicted as the rotation vector from the measured one
            // so are touches, whose measured value is that nothing is left between
            _ => Some(0.0),
        };
        for row in 0..recording.len() {
            let Some(measured) = measured(row).filter(|value| value.is_finite()) else {
                continue;
            };
            if predicted.has(index, row)
                && before[index][row].is_finite()
                && after[index][row].is_finite()
            {
                all.push(Prediction {
                    row,
                    channel: stream.name(),
                    measured,
                    before: measured - before[index][row],
                    after: measured - after[index][row],
                });
            }
        }
    }
    all
}
