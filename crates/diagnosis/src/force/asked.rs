//! Effects on torques that are asked for: fitted with the base model of the torques, with what they close on rows that the
//! fit did not see.

use haptical_calibration::channels;
use haptical_effects::device::{attached_at, bare};
use haptical_effects::{Context, streams};
use haptical_metrics::chi_square_p_value;
use haptical_model::{Device, DeviceEffect, Recording};
use nalgebra::DVector;

use super::along::Along;
use super::answer::values::Sizes;
use super::base::Base;
use super::base_of;
use super::changes::carried::Carried;
use super::changes::second::Model;
use super::effects::{Effects, is_scale};
use super::recorded::Recorded;
use super::select::{Pick, Selection};
use crate::DiagnosisError;
use crate::answer::HeldOutAnswer;
use crate::select::misfit;
use crate::select::scan::Score;
use crate::thresholds::torque::UNSEEN_PART;

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
    let mut index = 0;
    others.effects.retain(|_| {
        index += 1;
        !asked.contains(&(index - 1))
    });
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
) -> Result<Vec<AskedOfTorques>, DiagnosisError> {
    let none = |why: &str| AskedOfTorques {
        effect: None,
        p_value: None,
        why_not: Some(why.to_owned()),
        held_out: None,
    };
    let all = |why: &str| Ok(wanted.iter().map(|_| none(why)).collect());
    let channels = channels(rigid, recording).unwrap_or_default();
    let context = Context::new(rigid, recording, &streams(rigid, &channels))?;
    let recorded = match Recorded::new(&context) {
        Ok(recorded) => recorded,
        Err(why) => return all(&why),
    };
    let mut along = Along::new(&recorded)?;
    let Some((mut base, carried)) = base_of(&mut along, &[]) else {
        return all("the torques have no noise at all");
    };
    let effects = Effects::new(&along, &[]);
    let alone = base.regression.solution();
    let picks: Vec<Option<Pick>> = wanted
        .iter()
        .map(|wanted| effects.take_up(&mut base, wanted))
        .collect();
    let energy = effects.energy(&base);
    let sizes = Sizes::new(&effects, &base, misfit(&energy));
    let closed = second
        .map(|second| closed_on(&effects, (&base, &carried, &alone), &picks, second))
        .transpose()?
        .flatten();
    let answer = |(pick, wanted): (&Option<Pick>, &&DeviceEffect)| {
        let Some(pick) = pick else {
            return none(
                "the log does not show it, or what fits best has a sign that it cannot have",
            );
        };
        let (parameters, _) = sizes.parameters(pick);
        let effect = DeviceEffect {
            name: wanted.name.clone(),
            joint: wanted.joint,
            numbers: (parameters.iter())
                .map(|(name, answer)| (name.clone(), answer.value))
                .collect(),
            intervals: (parameters.iter())
                .map(|(name, answer)| (name.clone(), answer.ci95.map(Some)))
                .collect(),
            fit: true,
            ..DeviceEffect::default()
        };
        AskedOfTorques {
            effect: Some(effect),
            p_value: sizes.by_chance(pick),
            why_not: None,
            held_out: closed.clone(),
        }
    };
    Ok(picks.iter().zip(wanted).map(answer).collect())
}

/// What a model closes on a second recording of what its base alone leaves, of the torque with the largest gap there.
fn closed_on(
    effects: &Effects<'_, '_>,
    (base, carried, alone): (&Base, &Carried, &[f64]),
    picks: &[Option<Pick>],
    second: &Recording,
) -> Result<Option<HeldOutAnswer>, DiagnosisError> {
    let context = Context::new(effects.along.recorded.context.device, second, &[])?;
    let Ok(recorded) = Recorded::new(&context) else {
        return Ok(None);
    };
    let selection = Selection {
        picks: picks.iter().flatten().cloned().collect(),
        before: Vec::new(),
        after: Vec::new(),
        rest_before: Vec::new(),
        rest_after: Vec::new(),
    };
    let model = Model {
        effects,
        base,
        selection: &selection,
        carried,
    };
    let seen = model.predicted(&Along::new(&recorded)?, alone);
    let gap = |own: &HeldOutAnswer| own.rms_before / own.noise_floor.max(f64::MIN_POSITIVE);
    let channels = seen.held_out.into_iter();
    Ok(channels.max_by(|a, b| gap(a).total_cmp(&gap(b))))
}

impl Effects<'_, '_> {
    /// Takes an effect up into the model, at the shape at which it explains most; none where no shape of it is possible.
    fn take_up(&self, base: &mut Base, wanted: &DeviceEffect) -> Option<Pick> {
        let context = self.along.recorded.context;
        let is_wanted = |&index: &usize| {
            let own = self.effect(index);
            own.name() == wanted.name
                && own.joint() == wanted.joint
                && own.spec().further.is_empty()
                && self.is_tested(own)
        };
        let order = wanted.numbers.get("order").copied();
        let mut best: Option<Score> = None;
        for index in (0..self.all.len()).filter(is_wanted) {
            for shape in self.shapes(index) {
                if order.is_some_and(|order| order != shape) {
                    continue;
                }
                let score = Score {
                    effect: index,
                    shape,
                    ..base.score(self.columns(base, index, shape))
                };
                let is_possible =
                    score.rank > 0 && self.effect(index).is_possible(context, &score.amplitudes);
                let is_better = best
                    .as_ref()
                    .is_none_or(|best| self.merit(&score) > self.merit(best));
                if is_possible && is_better {
                    best = Some(score);
                }
            }
        }
        let score = best?;
        let pick = self.taken(base, &score);
        if is_scale(self.effect(score.effect)) {
            self.along.settle(base);
        }
        Some(pick)
    }
}

impl Sizes<'_, '_, '_> {
    /// Probability that noise alone gives amplitudes of this size; of a scale, that it is as stated.
    fn by_chance(&self, pick: &Pick) -> Option<f64> {
        let effect = self.effect(pick);
        if is_scale(effect) {
            let (gain, sd) = self.scale(effect);
            return chi_square_p_value((gain / sd).powi(2), 1.0).ok();
        }
        let (values, covariance) = self.amplitudes(pick);
        let values = DVector::from_column_slice(values);
        let square = values.dot(&covariance.cholesky()?.solve(&values));
        chi_square_p_value(square, values.len() as f64).ok()
    }
}
