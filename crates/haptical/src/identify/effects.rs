//! Effects that are fitted with geometry and drives.

mod on_torques;

use std::borrow::Cow;
use std::collections::BTreeMap;

use haptical_calibration::{
    Calibration, CalibrationError, CalibrationMethod, HeldOut, Options, ParameterFit, Weights,
    calibrate,
};
use haptical_diagnosis::{DiagnosisError, start_values, with_carried_loads};
use haptical_effects::device::{DeviceEffectError, PLACES, attached_at, effects_of, settle};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_effects::{Unit, spec};
use haptical_identification::Estimate;
use haptical_kinematics::nalgebra::{DMatrix, DVector};
use haptical_metrics::chi_square_p_value;
use haptical_model::{Device as Model, DeviceEffect, ParameterId, Recording};
use serde::Serialize;

/// Most fits: each leaves what the laws' curvature makes of the error before.
const MOST_FITS: usize = 4;
/// What effects add has settled where it moves by less than this part of the noise.
const SETTLED: f64 = 0.1;
/// Probability by chance below which an effect is shown: one in a thousand, because its shape was looked for too.
const SHOWN: f64 = 1e-3;

/// Half width of a normal 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.96;

/// An effect that was fitted.
#[derive(Debug, Clone, Serialize)]
pub struct EffectEntry {
    /// Name in the catalogue.
    pub effect: String,
    /// Joint, from 1, where it has one.
    pub joint: Option<usize>,
    /// Its numbers by name; none where the log says nothing of it.
    pub parameters: BTreeMap<String, EffectNumber>,
    /// Probability that noise alone gives an effect of this size; none where the log does not fix it.
    pub p_value: Option<f64>,
    /// Whether the log shows it. A law that it does not show is left out of the identified device; a joint's compliance stays
    /// there with its interval.
    pub shown: bool,
    /// The same in words.
    pub why: String,
}

/// A number of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EffectNumber {
    /// Value; none of a stiffness of what does not yield.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// 95 % interval; an end that the log leaves open is none.
    pub ci95: Option<[Option<f64>; 2]>,
}

/// Calibrates a device together with its effects, and says of each whether the log shows it; the device that is found has
/// those that it shows.
///
/// The laws are taken as straight about numbers that a refit of the diagnosis finds, and the fit is repeated until they
/// stand still.
pub(super) fn calibrate_with_effects(
    model: &Model,
    recording: &Recording,
    options: &Options,
) -> Result<(Calibration, Vec<EffectEntry>), DiagnosisError> {
    let mut rest = model.clone();
    let (asked, others): (Vec<DeviceEffect>, Vec<DeviceEffect>) = std::mem::take(&mut rest.effects)
        .into_iter()
        .partition(|effect| effect.fit && is_on_drives(effect));
    rest.effects = others;
    let loaded = with_carried_loads(&rest, recording);
    let carried = loaded.as_ref().unwrap_or(recording);
    let (mut calibration, mut entries) = with_laws(&rest, carried, options)?;
    entries.extend(compliances(&calibration));
    entries.extend(on_torques::fit(&mut calibration.device, recording, &asked)?);
    Ok((calibration, entries))
}

/// Whether an effect shows in torques alone: no channel of a calibration sees it.
fn is_on_drives(effect: &DeviceEffect) -> bool {
    spec(&effect.name).is_some_and(|spec| spec.hook.is_on_drives())
}

/// What is said of the joints that were asked whether they yield. They stay in the device with their intervals.
fn compliances(calibration: &Calibration) -> Vec<EffectEntry> {
    let Some(fit) = &calibration.fitted.whole else {
        return Vec::new();
    };
    let candidates = fit.parameters.iter().zip(&fit.estimates);
    let entry = |(id, estimate): (&ParameterId, &Estimate)| {
        let ParameterId::Compliance { joint } = *id else {
            return None;
        };
        let found = estimate.value.zip(estimate.standard_deviation);
        let found = found.filter(|(_, sd)| *sd > 0.0 && calibration.rejected.is_none());
        let stiffness = |compliance: f64| (compliance > 0.0).then(|| 1.0 / compliance);
        let number = found.map(|(value, _)| EffectNumber {
            value: stiffness(value),
            unit: Unit::NewtonMetrePerRadian.symbol(),
            // a compliance that may be 0 is a stiffness without an upper end
            ci95: (estimate.ci95).map(|[low, high]| [stiffness(high), stiffness(low)]),
        });
        let p_value = found.and_then(|(value, sd)| {
            let p = chi_square_p_value((value / sd).powi(2), 1.0).ok()?;
            Some(if value > 0.0 { p } else { 1.0 })
        });
        let shown = p_value.is_some_and(|p| p < SHOWN);
        Some(EffectEntry {
            effect: JOINT_COMPLIANCE.name.to_owned(),
            joint: Some(joint + 1),
            parameters: (number.into_iter())
                .map(|number| (JOINT_COMPLIANCE.parameters[0].name.to_owned(), number))
                .collect(),
            p_value,
            shown,
            why: why(p_value, shown),
        })
    };
    candidates.filter_map(entry).collect()
}

fn why(p_value: Option<f64>, shown: bool) -> String {
    match p_value {
        None => "the log does not fix it beside geometry and drives".to_owned(),
        Some(p) if shown && p < 1e-12 => "the log shows it beyond doubt".to_owned(),
        Some(p) if shown => format!("the log shows it (p = {p:.1e})"),
        Some(p) => format!("noise alone gives as much with probability {p:.2}"),
    }
}

fn with_laws(
    model: &Model,
    recording: &Recording,
    options: &Options,
) -> Result<(Calibration, Vec<EffectEntry>), DiagnosisError> {
    if model.effects.is_empty() {
        return Ok((calibrate(model, recording, options)?, Vec::new()));
    }
    let is_fitted = model.effects.iter().any(|effect| effect.fit);
    if is_fitted && options.method == CalibrationMethod::TwoStep {
        return Err(CalibrationError::Option {
            name: "method",
            value: "two-step".to_owned(),
            allowed: "effects are fitted with everything else at once, by the method joint",
        }
        .into());
    }
    let found = fitted(model, recording, options)?;
    let entries = entries(&found)?;
    let is_kept = |index: &usize| {
        let mut own = entries.iter().filter(|(own, _)| own == index);
        match is_new(model, *index) {
            true => own.any(|(_, entry)| entry.shown),
            false => is_possible(&found.calibration.device, *index),
        }
    };
    let kept: Vec<usize> = (0..model.effects.len()).filter(is_kept).collect();
    let entries: Vec<EffectEntry> = entries.into_iter().map(|(_, entry)| entry).collect();
    if kept.len() == model.effects.len() {
        return Ok((found.calibration, entries));
    }
    let mut without = model.clone();
    without.effects = kept
        .iter()
        .map(|&index| found.start.effects[index].clone())
        .collect();
    if without.effects.is_empty() {
        return Ok((calibrate(&without, recording, options)?, entries));
    }
    let again = fitted(&without, recording, options)?;
    let told = self::entries(&again)?;
    // what was left out keeps what was found of it
    let of_place = |entry: &EffectEntry| {
        let own = told.iter().map(|(_, own)| own);
        let place = |entry: &EffectEntry| {
            let number = |key: &str| entry.parameters.get(key).and_then(|own| own.value);
            let numbers = PLACES.map(number);
            (entry.effect.clone(), entry.joint, numbers)
        };
        let mut own = own.filter(|own| place(own) == place(entry));
        own.next().filter(|_| entry.shown).cloned()
    };
    let entries = entries.into_iter();
    let entries = entries.map(|entry| of_place(&entry).unwrap_or(entry));
    Ok((again.calibration, entries.collect()))
}

/// Whether an effect was asked for without a size: the device as it was does not have it.
fn is_new(model: &Model, index: usize) -> bool {
    let effect = &model.effects[index];
    let own = spec(&effect.name);
    let sizes = own.into_iter().flat_map(|spec| spec.parameters);
    let mut sizes = sizes.filter(|parameter| parameter.is_size());
    effect.fit && !sizes.any(|size| effect.numbers.contains_key(size.name))
}

/// Whether a device can have an effect with the numbers that were found for it: noise makes a play as often negative as
/// positive.
fn is_possible(device: &Model, index: usize) -> bool {
    let mut alone = device.clone();
    alone.effects = device.effects.get(index).cloned().into_iter().collect();
    effects_of(&alone).is_ok()
}

/// A finished fit.
struct Fitted<'r> {
    calibration: Calibration,
    /// The device with the numbers that the laws were straightened about.
    start: Model,
    recording: &'r Recording,
    /// The device whose geometry they were straightened at.
    at: Model,
}

fn fitted<'r>(
    model: &Model,
    recording: &'r Recording,
    options: &Options,
) -> Result<Fitted<'r>, DiagnosisError> {
    let mut start = start_values(model, recording, options.loss)?;
    for (index, effect) in model.effects.iter().enumerate() {
        if !is_possible(&start, index) {
            start.effects[index].numbers.clone_from(&effect.numbers);
        }
    }
    // effects of a nominal device are not where those of the real one are: a spring that gives by a degree, at a length that is a
    // millimetre off, moves the handle by more than noise
    let mut at = start.clone();
    let mut before: Option<Cow<'_, Recording>> = None;
    let mut round = 0;
    loop {
        round += 1;
        let mut there = start.clone();
        let with = attached_at(&mut there, &at, recording)?;
        for index in 0..there.effects.len() {
            if is_new(model, index) {
                // before the fit the device has none of it
                let numbers = there.effects[index].fitted.iter_mut();
                numbers.for_each(|number| number.value = 0.0);
            }
        }
        let stands = |before: &Cow<'_, Recording>| is_same(before, &with, &at);
        let is_last = round == MOST_FITS || before.as_ref().is_some_and(stands);
        let options = &Options {
            held_out: match is_last {
                true => options.held_out,
                false => HeldOut::None,
            },
            ..options.clone()
        };
        let calibration = calibrate(&there, &with, options)?;
        let mut found = Fitted {
            calibration,
            start,
            recording,
            at,
        };
        found.settle()?;
        let device = &found.calibration.device;
        let mut all = 0..device.effects.len();
        // about numbers that no law has nothing is straightened: such an effect is left out
        if is_last || !all.all(|index| is_possible(device, index)) {
            return Ok(found);
        }
        start = found.start;
        start.effects.clone_from(&found.calibration.device.effects);
        at = found.calibration.device;
        before = Some(with);
    }
}

/// Whether effects add the same as in the round before, to a small part of the channels' noise.
fn is_same(before: &Recording, now: &Recording, device: &Model) -> bool {
    let channels = haptical_calibration::channels(device, now).unwrap_or_default();
    let weights = Weights::stated(device, &channels);
    let noise = |name: &str| {
        let mut all = weights.channel_sd.iter();
        let own = all.find(|(channel, _)| channel.name() == name);
        own.map(|(_, sd)| *sd)
    };
    let pairs = before.added.iter().zip(&now.added);
    let mut moved = pairs.map(|(before, now)| {
        let pairs = before.readings.iter().zip(&now.readings);
        let square: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
        let rms = (square / before.readings.len().max(1) as f64).sqrt();
        noise(&now.channel).map_or(0.0, |sd| rms / sd)
    });
    moved.all(|moved| moved <= SETTLED)
}

impl Fitted<'_> {
    fn fit(&self) -> Option<&ParameterFit> {
        self.calibration.fitted.whole.as_ref()
    }

    /// Covariance of an effect's fitted numbers, of normal deviations that have the half widths of the numbers' own intervals;
    /// none where one of them is not fixed.
    fn covariance(&self, effect: usize, count: usize) -> Option<DMatrix<f64>> {
        let fit = self.fit()?;
        let (uncertain, covariance) = fit.uncertain();
        let place = |number: usize| {
            let id = ParameterId::Effect { effect, number };
            let at = fit.parameters.iter().position(|own| *own == id)?;
            fit.fitted.contains(&at).then_some(())?;
            let estimate = &fit.estimates[at];
            let normal = |[low, high]: [f64; 2]| 0.5 * (high - low) / NORMAL_95;
            let sd = estimate.ci95.map(normal).or(estimate.standard_deviation)?;
            Some((uncertain.iter().position(|own| *own == id)?, sd))
        };
        let places: Option<Vec<(usize, f64)>> = (0..count).map(place).collect();
        let places = places.filter(|places| !places.is_empty())?;
        // the estimates' intervals count more than the covariance does: a noise with a memory has few degrees of freedom
        let scaled =
            |(at, sd): (usize, f64)| (at, sd / covariance[(at, at)].max(f64::MIN_POSITIVE).sqrt());
        let places: Vec<(usize, f64)> = places.into_iter().map(scaled).collect();
        Some(DMatrix::from_fn(count, count, |a, b| {
            let ((a, by_a), (b, by_b)) = (places[a], places[b]);
            covariance[(a, b)] * by_a * by_b
        }))
    }

    /// Puts names and intervals in the place of the fitted numbers.
    fn settle(&mut self) -> Result<(), DeviceEffectError> {
        let effects = self.calibration.device.effects.iter().enumerate();
        let covariances = effects.map(|(at, effect)| self.covariance(at, effect.fitted.len()));
        let covariances: Vec<Option<DMatrix<f64>>> = covariances.collect();
        // what the numbers are worked out from is the device that the laws were straightened about
        let own = |effect: usize| covariances.get(effect).cloned().flatten();
        let mut device = self.at.clone();
        device.effects.clone_from(&self.calibration.device.effects);
        for (effect, start) in device.effects.iter_mut().zip(&self.start.effects) {
            effect.numbers.clone_from(&start.numbers);
        }
        settle(&mut device, self.recording, &own)?;
        self.calibration.device.effects = device.effects;
        if let Some(rejected) = &mut self.calibration.rejected {
            settle(&mut rejected.device, self.recording, &|_| None)?;
        }
        Ok(())
    }
}

/// What is said of each fitted effect, with its position in the device.
fn entries(found: &Fitted<'_>) -> Result<Vec<(usize, EffectEntry)>, DiagnosisError> {
    let device = &found.calibration.device;
    let Some(fit) = found.fit() else {
        return Ok(Vec::new());
    };
    let mut entries = Vec::new();
    for (index, effect) in device.effects.iter().enumerate() {
        let of_effect = |id: &&ParameterId| matches!(id, ParameterId::Effect { effect, .. } if *effect == index);
        let own = || fit.parameters.iter().filter(of_effect);
        let values: Vec<f64> = own().map(|id| id.value(&fit.device)).collect();
        if values.is_empty() {
            continue;
        }
        // the logarithm of a shape says nothing of whether there is an effect
        let names = own().map(|id| id.name(&fit.device));
        let sizes = names.filter(|name| !name.ends_with(".log_shape")).count();
        let covariance = found.covariance(index, values.len());
        let p_value = covariance.and_then(|own| by_chance(&values[..sizes], &own));
        // a size that nature does not allow is not written into the device
        let mut names = effect.numbers.keys();
        let has_size = names.any(|name| !PLACES.contains(&name.as_str()));
        let is_possible = has_size && is_possible(device, index);
        let is_told = p_value.is_some_and(|p| p < SHOWN) && found.calibration.rejected.is_none();
        let shown = is_told && is_possible;
        let entry = EffectEntry {
            effect: effect.name.clone(),
            joint: effect.joint.map(|joint| joint + 1),
            parameters: numbers(effect),
            p_value,
            shown,
            why: match is_possible {
                true => why(p_value, shown),
                false => "what fits best has a sign that it cannot have".to_owned(),
            },
        };
        entries.push((index, entry));
    }
    Ok(entries)
}

/// What is said of effects that were put into a model with numbers that stay.
pub(super) fn held(before: &Model, model: &Model) -> Vec<EffectEntry> {
    let is_held = |own: &&DeviceEffect| !own.fit && !before.effects.contains(own);
    let own = model.effects.iter().filter(is_held);
    let entry = |effect: &DeviceEffect| EffectEntry {
        effect: effect.name.clone(),
        joint: effect.joint.map(|joint| joint + 1),
        parameters: (numbers(effect).into_iter())
            .filter(|(name, _)| effect.intervals.contains_key(name))
            .collect(),
        p_value: None,
        shown: true,
        why: "the diagnosis shows it behind its low pass; held here".to_owned(),
    };
    own.map(entry).collect()
}

/// The numbers of an effect with their units and intervals, by name.
fn numbers(effect: &DeviceEffect) -> BTreeMap<String, EffectNumber> {
    let number = |(name, value): (&String, &f64)| {
        let number = EffectNumber {
            value: Some(*value),
            unit: Unit::by_name(name).symbol(),
            ci95: effect.intervals.get(name).copied(),
        };
        (name.clone(), number)
    };
    effect.numbers.iter().map(number).collect()
}

/// Probability that noise alone gives amplitudes of this size.
fn by_chance(amplitudes: &[f64], covariance: &DMatrix<f64>) -> Option<f64> {
    let count = amplitudes.len();
    let own = covariance.view((0, 0), (count, count)).into_owned();
    let values = DVector::from_column_slice(amplitudes);
    let square = values.dot(&own.cholesky()?.solve(&values));
    chi_square_p_value(square, count as f64).ok()
}
