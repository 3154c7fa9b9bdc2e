//! Effects on torques that are asked for: fitted with the base model of the torques, with what they close on rows that the
//! fit did not see.

use haptical_calibration::channels;
use haptical_effects::device::{attached_at, bare};
use haptical_effects::{Context, streams};
use haptical_metrics::chi_square_p_value;
use haptical_model::{Device, DeviceEffect, Recording};
use haptical_motion::Unseen;
use nalgebra::DVector;

use super::Model;
use super::along::Along;
use super::answer::Sizes;
use super::effects::is_scale;
use super::recorded::{Recorded, may_be_held};
use super::select::Pick;
use crate::answer::{HeldOutAnswer, held_out};
use crate::select::misfit;
use crate::thresholds::torque::UNSEEN_PART;
use crate::{DiagnosisError, Result};

/// What the torques say of an effect that was asked for.
#[derive(Debug, Clone)]
pub struct AskedOfTorques {
    /// The effect with its numbers and 95 % intervals; none where nothing can be said, or what fits best cannot be.
    pub effect: Option<DeviceEffect>,
    /// Probability that noise alone gives amplitudes of this size.
    pub p_value: Option<f64>,
    /// Why there is none.
    pub why_not: Option<String>,
    /// The torque with the largest gap on the last third of the rows, before and after, by a fit to those before; none where
    /// either part is too short.
    pub held_out: Option<HeldOutAnswer>,
}

impl AskedOfTorques {
    fn none(why: &str) -> Self {
        Self {
            effect: None,
            p_value: None,
            why_not: Some(why.to_owned()),
            held_out: None,
        }
    }
}

/// Fits some of a device's effects on torques (by position within [`Device::effects`]) together, beside inertial numbers of all
/// links, scales of the torques and geometry within its tolerance; the other effects of the device are taken off the readings.
/// The answers are in the order of `asked`.
///
/// Source: docs/diagnosis-force.md.
///
/// # Errors
/// [`DiagnosisError`] where the device has no value at a row or one of its effects none.
pub fn ask_torques(
    device: &Device,
    recording: &Recording,
    asked: &[usize],
) -> Result<Vec<AskedOfTorques>, DiagnosisError> {
    let wanted: Vec<&DeviceEffect> = asked.iter().map(|&index| &device.effects[index]).collect();
    let mut others = device.clone();
    let mut indices = 0..device.effects.len();
    (others.effects).retain(|_| indices.next().is_none_or(|index| !asked.contains(&index)));
    let at = others.clone();
    let recording = attached_at(&mut others, &at, recording)?;
    let rigid = bare(&others);
    let mut answers = fitted(&rigid, &recording, None, &wanted)?;
    let seen = ((1.0 - UNSEEN_PART) * recording.len() as f64) as usize;
    let part = |rows: std::ops::Range<usize>| recording.select(&rows.collect::<Vec<usize>>());
    let (first, second) = (part(0..seen), part(seen..recording.len()));
    // each by itself: what one closes is not the merit of the other
    for (answer, wanted) in answers.iter_mut().zip(&wanted) {
        let alone = fitted(&rigid, &first, Some(&second), &[wanted])?;
        answer.held_out = alone.into_iter().next().and_then(|own| own.held_out);
    }
    Ok(answers)
}

/// The same of a device without effects; what is closed on a second recording, where there is one.
fn fitted(
    rigid: &Device,
    recording: &Recording,
    second: Option<&Recording>,
    wanted: &[&DeviceEffect],
) -> Result<Vec<AskedOfTorques>> {
    let channels = channels(rigid, recording).unwrap_or_default();
    let context = Context::new(rigid, recording, &streams(rigid, &channels))?;
    let mut model = match Model::new(&context, may_be_held(&context), &[])? {
        Ok(model) => model,
        Err(why) => return Ok(vec![AskedOfTorques::none(&why); wanted.len()]),
    };
    let picks = wanted.iter().map(|wanted| model.take_up(wanted));
    let picks: Vec<Option<Pick>> = picks.collect();
    model.selection.picks = picks.iter().flatten().cloned().collect();
    let held_out = second.map(|second| model.closed_on(second)).transpose()?;
    let sizes = Sizes::new(&model, misfit(&model.effects.energy(&model.base)));
    let answer = |(pick, wanted): (&Option<Pick>, &&DeviceEffect)| {
        let Some(pick) = pick else {
            let why = "the log does not show it, or what fits best has a sign that it cannot have";
            return AskedOfTorques::none(why);
        };
        let (parameters, _) = sizes.parameters(pick);
        let numbers = parameters
            .iter()
            .map(|(name, number)| (name.clone(), number.value));
        let intervals = parameters.iter();
        let intervals = intervals.map(|(name, number)| (name.clone(), number.ci95.map(Some)));
        let effect = DeviceEffect {
            name: wanted.name.clone(),
            joint: wanted.joint,
            numbers: numbers.collect(),
            intervals: intervals.collect(),
            fit: true,
            ..DeviceEffect::default()
        };
        AskedOfTorques {
            effect: Some(effect),
            p_value: sizes.by_chance(pick),
            why_not: None,
            held_out: held_out.clone().flatten(),
        }
    };
    Ok(picks.iter().zip(wanted).map(answer).collect())
}

impl Model<'_> {
    /// What the effects close on a second recording, for the torque with the largest gap there. That gap is what the
    /// base model alone leaves.
    fn closed_on(&self, second: &Recording) -> Result<Option<HeldOutAnswer>> {
        let context = Context::new(self.effects.along.recorded.context.device, second, &[])?;
        let Ok(recorded) = Recorded::new(&context, false) else {
            return Ok(None);
        };
        let unseen = self.predicted(&Along::new(recorded)?);
        let gap =
            |unseen: &Unseen| unseen.before.iter().sum::<f64>() / unseen.noise.powi(2).max(1e-300);
        let largest = unseen.iter().max_by(|a, b| gap(a).total_cmp(&gap(b)));
        let recorded = &self.effects.along.recorded;
        Ok(largest.and_then(|unseen| {
            let channel = recorded.channel(unseen.joint)?;
            Some(held_out(recorded.named(channel), unseen, &unseen.after))
        }))
    }

    /// Takes an effect up into the model, at the shape at which it explains most; none where no shape of it is possible.
    fn take_up(&mut self, wanted: &DeviceEffect) -> Option<Pick> {
        let (effects, base) = (&self.effects, &mut self.base);
        let is_wanted = |index: &&usize| {
            let effect = effects.effect(**index);
            let is_it = effect.name() == wanted.name && effect.joint() == wanted.joint;
            is_it && effect.spec().further.is_empty()
        };
        let order = wanted.numbers.get("order");
        let at_shapes = |&index: &usize| {
            let shapes = effects.shapes(index).into_iter();
            let wanted = shapes.filter(|shape| order.is_none_or(|order| order == shape));
            wanted.map(move |shape| (index, shape))
        };
        let shaped = effects.tested.iter().filter(is_wanted).flat_map(at_shapes);
        let scores = shaped.map(|(effect, shape)| {
            let columns = effects.columns(base, effect, shape);
            base.score(&columns, effect, shape)
        });
        let possible = scores.filter(|score| effects.is_possible(score));
        // of equal merits the first wins
        let best =
            possible.reduce(
                |best, other| match effects.merit(&other) > effects.merit(&best) {
                    true => other,
                    false => best,
                },
            )?;
        Some(effects.taken(base, &best))
    }
}

impl Sizes<'_, '_> {
    /// Probability that noise alone gives amplitudes of this size; of a scale, that it is as stated.
    fn by_chance(&self, pick: &Pick) -> Option<f64> {
        let effect = self.model.effects.effect(pick.effect);
        if is_scale(effect) {
            let (gain, sd) = self.scale(pick);
            return chi_square_p_value((gain / sd).powi(2), 1.0).ok();
        }
        let (values, covariance) = self.amplitudes(pick);
        let values = DVector::from_column_slice(values);
        let square = values.dot(&covariance.cholesky()?.solve(&values));
        chi_square_p_value(square, values.len() as f64).ok()
    }
}
