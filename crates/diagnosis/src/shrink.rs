//! How far the gap shrinks on data that the fit did not see: a second recording, or blocks held back.

use std::collections::BTreeMap;

use haptical_calibration::{Channel, HeldOut, channels, split};
use haptical_metrics::{Bootstrap, gap_reduction_percent};
use haptical_model::Recording;

use crate::DiagnosisError;
use crate::answer::{HeldOutAnswer, Prediction};
use crate::base::Base;
use crate::catalogue::Effect;
use crate::cleaning::without_readings;
use crate::context::Stream;
use crate::earlier_model::{placed, places};
use crate::engine::{Engine, Prepared};
use crate::events::{event_score, with_more_steps};
use crate::model::Cause;
use crate::select::{Selection, Selector};
use crate::system::compress_rows;

/// Residuals of one channel on unseen rows, without and with the causes.
#[derive(Debug, Clone)]
pub(crate) struct Unseen {
    pub(crate) channel: Channel,
    unit: &'static str,
    before: Vec<f64>,
    after: Vec<f64>,
    floor: f64,
    /// Relative standard deviation of the floor's square.
    floor_uncertainty: f64,
}

/// Residuals on unseen data.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shrink {
    pub(crate) channels: Vec<Unseen>,
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) description: String,
    pub(crate) warnings: Vec<String>,
}

/// Seed of the moving-block bootstrap behind the intervals of a reduction.
pub const BOOTSTRAP_SEED: u64 = 1;
/// Rows in a block of the bootstrap.
const BLOCK_ROWS: usize = 50;
/// Share of the rows that is held back without a second recording.
const HELD_BACK: f64 = 0.2;

/// Fits base model and causes to part of the recording, and predicts the rest.
pub(crate) fn on_held_back(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    recording: &Recording,
    earlier: Option<&[Vec<f64>]>,
) -> Result<Shrink, DiagnosisError> {
    let engine = selector.engine;
    let (held, description) = if of_postures(engine) {
        let description = "every fifth touch of each point or plane".to_owned();
        (every_fifth_touch(recording), description)
    } else {
        let split = split(recording, HeldOut::Share(HELD_BACK))?;
        let mut held = vec![false; recording.len()];
        for &row in &split.held_out {
            held[row] = true;
        }
        (held, split.description)
    };
    if held.iter().filter(|held| **held).count() < 8 {
        return Ok(Shrink::default());
    }
    let seen = |row: usize| !held[row];
    let part = engine.part(&seen)?;
    let plain = engine.refit_on(&part, selector.effects, &engine.start.model)?;
    let with = engine.refit_on(&part, selector.effects, &selection.refit.model)?;
    let before = earlier.unwrap_or(&plain.residual);
    let after = &with.residual;
    let rows = |stream: usize, row: usize| held[row] && engine.usable[stream][row];
    Ok(Shrink {
        channels: collect(engine, &rows, before, after),
        predictions: Vec::new(),
        description,
        warnings: Vec::new(),
    })
}

/// Whether the rows are single postures at which something is touched: what was touched has no place where
/// all its touches are held back, and neighbours say nothing of each other.
fn of_postures(engine: &Engine<'_>) -> bool {
    let context = &engine.context;
    !context.ordered && context.streams.iter().any(Stream::is_touch)
}

/// Of each point and plane the fifth touch, the tenth, ...
fn every_fifth_touch(recording: &Recording) -> Vec<bool> {
    let mut touches: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    (0..recording.len())
        .map(|row| {
            let count = touches
                .entry((id(&recording.contact, row), id(&recording.plane, row)))
                .or_default();
            *count += 1;
            count.is_multiple_of(5)
        })
        .collect()
}

/// What a row touches; nothing where there is no such column.
fn id(ids: &Option<Vec<String>>, row: usize) -> &str {
    let id = ids.as_ref().and_then(|ids| ids.get(row));
    id.map_or("", String::as_str)
}

/// Predicts a second recording with the models of the first. Events belong to one recording: their
/// instants and sizes are looked for in the second one.
pub(crate) fn on_second(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    validation: &Recording,
    outlier_sd: f64,
    earlier: Option<&Base>,
) -> Result<Shrink, DiagnosisError> {
    let touched = Touched::new(selector, selection, validation)?;
    let base = touched
        .as_ref()
        .map_or(selector.engine.base, |touched| &touched.with);
    let prepared = Prepared::new(base, validation)?;
    let gone = prepared.outlying(outlier_sd);
    let cleaned = without_readings(validation, &gone);
    let second = prepared.without(&gone, &cleaned).fit(None)?;
    let effects = selector.effects;
    let mut warnings = Vec::new();
    let causes: Vec<Cause> = selection
        .refit
        .model
        .causes
        .iter()
        .filter_map(|cause| in_second(&second, effects, cause))
        .collect();
    let before = match (earlier, &touched) {
        (Some(model), Some(_)) => {
            let there = placed(&model.device, &base.device, validation, &base.channels)?;
            model_residual(&there, &cleaned, &second)?
        }
        (Some(model), None) => model_residual(model, &cleaned, &second)?,
        (None, Some(touched)) => model_residual(&touched.plain, &cleaned, &second)?,
        (None, None) => second.residual_of(effects, &selector.engine.start.model.values, &[])?,
    };
    let with = match touched {
        Some(_) => places_beside(&second, effects, &causes)?,
        None => selection.refit.model.values.clone(),
    };
    let after = second.residual_of(effects, &with, &causes)?;
    let known: Vec<bool> = (0..validation.len())
        .map(|row| {
            base.device
                .joints
                .iter()
                .zip(&validation.joint)
                .all(|(joint, column)| joint.error_is_known_at(column[row]))
        })
        .collect();
    let outside = known.iter().filter(|known| !**known).count();
    if outside > 0 {
        warnings.push(format!(
            "{outside} rows of the second recording lie outside the range of a transmission's polynomial \
             and are left out"
        ));
    }
    let rows = |stream: usize, row: usize| known[row] && second.usable[stream][row];
    Ok(Shrink {
        channels: collect(&second, &rows, &before, &after),
        predictions: predictions(&second, validation, &before, &after, &known),
        description: "the second recording".to_owned(),
        warnings,
    })
}

/// The models of the first recording where the second one touches something: nobody knows where it stands, so its
/// places are fitted with the models held.
struct Touched {
    /// Without the causes, and with them.
    plain: Base,
    with: Base,
}

impl Touched {
    fn new(
        selector: &Selector<'_, '_>,
        selection: &Selection,
        validation: &Recording,
    ) -> Result<Option<Self>, DiagnosisError> {
        if validation.contact.is_none() && validation.plane.is_none() {
            return Ok(None);
        }
        let engine = selector.engine;
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

/// Where the touched points and planes of a second recording stand once the causes are in the model: Gauss-Newton,
/// exact in one step but for known distances.
fn places_beside(
    second: &Engine<'_>,
    effects: &[Box<dyn Effect>],
    causes: &[Cause],
) -> Result<Vec<f64>, DiagnosisError> {
    let mut values = second.start.model.values.clone();
    for _ in 0..3 {
        let Some(basis) = &second.whole.basis else {
            break;
        };
        let residual = second.residual_of(effects, &values, causes)?;
        let step = basis.solve(&compress_rows(&second.whole.blocks, &residual))?;
        for (&parameter, change) in second.base.free.iter().zip(&step) {
            values[parameter] += change;
        }
    }
    Ok(values)
}

/// Residuals of a model identified earlier, stream by stream.
pub(crate) fn model_residual(
    model: &Base,
    recording: &Recording,
    engine: &Engine<'_>,
) -> Result<Vec<Vec<f64>>, DiagnosisError> {
    let weights = haptical_calibration::Weights::stated(&model.device, &model.channels);
    let streams = &engine.context.streams;
    let problem = crate::base::BaseProblem::new(model, recording, streams, &weights)?;
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
    let score = event_score(&second.system, &second.context, effect, cause.effect)?;
    let found = with_more_steps(&second.system, &second.context, effect, score);
    (found.score > 40.0).then(|| Cause::of(&found))
}

fn collect(
    engine: &Engine<'_>,
    wanted: &dyn Fn(usize, usize) -> bool,
    before: &[Vec<f64>],
    after: &[Vec<f64>],
) -> Vec<Unseen> {
    let streams = &engine.context.streams;
    let mut channels: Vec<Unseen> = Vec::new();
    for (index, stream) in streams.iter().enumerate() {
        let rows: Vec<usize> = (0..before[index].len())
            .filter(|&row| wanted(index, row))
            .collect();
        let pick = |residual: &[f64]| rows.iter().map(|&row| residual[row]).collect::<Vec<f64>>();
        let entry = Unseen {
            channel: stream.channel,
            unit: stream.unit,
            before: pick(&before[index]),
            after: pick(&after[index]),
            floor: engine.floor[index],
            floor_uncertainty: engine.noise[index].uncertainty,
        };
        match channels
            .iter_mut()
            .find(|other| other.channel == entry.channel)
        {
            Some(other) => {
                let (have, more) = (other.before.len() as f64, entry.before.len() as f64);
                if have + more > 0.0 {
                    other.floor = ((other.floor.powi(2) * have + entry.floor.powi(2) * more)
                        / (have + more))
                        .sqrt();
                }
                other.before.extend(entry.before);
                other.after.extend(entry.after);
            }
            None => channels.push(entry),
        }
    }
    channels.retain(|channel| channel.before.len() >= 8);
    channels
}

fn predictions(
    engine: &Engine<'_>,
    recording: &Recording,
    before: &[Vec<f64>],
    after: &[Vec<f64>],
    known: &[bool],
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
        for (row, known) in known.iter().enumerate() {
            let Some(measured) = measured(row).filter(|value| value.is_finite()) else {
                continue;
            };
            if *known && before[index][row].is_finite() && after[index][row].is_finite() {
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

impl Unseen {
    /// Root mean squares, closed share and its 95 % interval: moving blocks of rows and the
    /// uncertainty of the noise floor.
    pub(crate) fn answer(&self) -> HeldOutAnswer {
        let all: Vec<usize> = (0..self.before.len()).collect();
        let rms_before = rms(&self.before, &all);
        let rms_after = rms(&self.after, &all);
        HeldOutAnswer {
            channel: self.channel.name(),
            rms_before,
            rms_after,
            noise_floor: self.floor,
            unit: self.unit.to_owned(),
            reduction_percent: gap_reduction_percent(rms_before, rms_after, self.floor),
            reduction_ci95: self.interval(rms_before),
        }
    }

    /// Whitened gap before: where a cause shows most.
    pub(crate) fn gap(&self) -> f64 {
        let all: Vec<usize> = (0..self.before.len()).collect();
        rms(&self.before, &all) / self.floor.max(1e-300)
    }

    /// What the causes take off the whitened residual.
    pub(crate) fn gained(&self) -> f64 {
        let all: Vec<usize> = (0..self.before.len()).collect();
        let square = rms(&self.before, &all).powi(2) - rms(&self.after, &all).powi(2);
        square / self.floor.max(1e-300).powi(2)
    }

    fn interval(&self, rms_before: f64) -> Option<[f64; 2]> {
        if rms_before <= self.floor {
            return None;
        }
        let bootstrap = Bootstrap {
            replicates: 400,
            seed: BOOTSTRAP_SEED,
            level: 0.95,
            block_length: BLOCK_ROWS.min(self.before.len() / 4).max(1),
        };
        // q = (after^2 - floor^2) / (before^2 - floor^2), the share of the square that is left
        let left = |rows: &[usize], floor_square: f64| {
            let before = rms(&self.before, rows).powi(2) - floor_square;
            let after = rms(&self.after, rows).powi(2) - floor_square;
            (before > 0.0).then(|| after / before)
        };
        let floor = self.floor.powi(2);
        let spread = 1.96 * self.floor_uncertainty;
        let ends = |floor_square: f64| {
            bootstrap
                .interval(self.before.len(), |rows| left(rows, floor_square))
                .ok()
        };
        let middle = ends(floor)?;
        let all: Vec<usize> = (0..self.before.len()).collect();
        let here = left(&all, floor)?;
        let by_floor = |sign: f64| left(&all, floor * (1.0 + sign * spread));
        let (low, high) = (
            by_floor(1.0).unwrap_or(here),
            by_floor(-1.0).unwrap_or(here),
        );
        // both spreads in quadrature on either side
        let most = here + (middle.high - here).max(0.0).hypot((high - here).max(0.0));
        let least = here - (here - middle.low).max(0.0).hypot((here - low).max(0.0));
        let percent = |left: f64| 100.0 * (1.0 - left.max(0.0).sqrt());
        Some([percent(most), percent(least)])
    }
}

fn rms(values: &[f64], rows: &[usize]) -> f64 {
    let sum: f64 = rows.iter().map(|&row| values[row] * values[row]).sum();
    (sum / rows.len().max(1) as f64).sqrt()
}
