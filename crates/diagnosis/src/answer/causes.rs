//! Causes as they are answered: names, probabilities, parameters with intervals, shrink.

use std::collections::BTreeMap;

use haptical_effects::noise::{NOISE_LEVEL, OUTLIERS};
use haptical_effects::{Effect, Family, Hook, Need, Role, Spec};

use nalgebra::DMatrix;

use crate::answer::{CauseAnswer, HeldOutAnswer, NoiseAnswer, ParameterAnswer, Shrink, Unseen};
use crate::engine::Cause;
use crate::judge::{BaseTerm, Findings, is_reported, warms_with_time};
use crate::noise::NoiseSource;
use crate::select::{Rival, Selection, Selector, StepPlace, is_displacement, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::earlier_model::{SURE, TOOL_ODDS};
use crate::thresholds::noise::{DATA_PROBABILITY, GROWS_WITH_SPEED, LEVEL_SD, LOUD, MANY_OUTLIERS};
use crate::thresholds::rivals::{LOOK_ALIKE, SETTLING, STEADY};
use crate::thresholds::unseen::SHOWN_BY_ENCODER;
use haptical_effects::device::with_variances;

/// The causes that positions show, strongest first.
pub(crate) fn position_causes(findings: &Findings<'_>) -> Vec<CauseAnswer> {
    let base_terms = &findings.base_terms;
    let total: f64 = findings.selection.explained.iter().sum::<f64>() + base_terms.total;
    let terms = base_terms.terms.iter();
    let mut causes: Vec<CauseAnswer> = terms
        .map(|term| base_term(term, total, &findings.shrink))
        .collect();
    for index in 0..findings.rivals.len() {
        let answer = cause_answer(findings, index, total);
        if causes.is_empty() || is_reported(&answer) {
            causes.push(answer);
        }
    }
    if !base_terms.terms.is_empty() {
        causes.sort_by(|a, b| b.share.total_cmp(&a.share));
    }
    causes
}

/// One cause of a selection.
fn cause_answer(findings: &Findings<'_>, index: usize, total: f64) -> CauseAnswer {
    let Findings {
        selection,
        adequacy,
        shrink,
        ..
    } = findings;
    let rivals = &findings.rivals[index];
    let cause = &selection.causes()[index];
    let effect = selection.effect(cause);
    let (amplitudes, shape) = reported(cause);
    let values = effect.values(&selection.engine().context, &amplitudes, shape);
    let confusable = confusable(rivals);
    let own = rivals.first().map_or(1.0, |rival| rival.probability);
    let mut probability = own * (1.0 - adequacy.doubt());
    if is_seen_again(selection, rivals, effect) {
        // what could have settled or crept in its place was tried in several runs, and explains less
    } else if effect.spec().family == Family::Drift && cause.shape != 0.0 {
        // a drift that settles has no law of its own: many things settle
        probability *= SETTLING;
    } else if effect.spec().family == Family::Drift && !effect.spec().look_alikes.is_empty() {
        // a cable that creeps under a steady load drifts as steadily
        probability *= STEADY;
    } else if effect.spec().family == Family::Drift
        && confusable.is_empty()
        && !is_time_tried(&selection.selector, effect)
    {
        // a law of time, which was not tried, may have the same course
        probability *= STEADY;
    }
    let class: f64 = rivals
        .iter()
        .filter(|rival| rival.nats_behind <= CONFUSABLE_NATS)
        .map(|rival| rival.probability)
        .sum();
    let plausible = effect.is_plausible(&values);
    CauseAnswer {
        class_probability: (class * (1.0 - adequacy.doubt())).max(probability),
        confusable_with: confusable,
        parameters: parameters(selection, index),
        plausible,
        implausible: !plausible,
        share: selection.explained[index] / total.max(1e-300),
        held_out: held_out(shrink, effect.spec().hook, effect.joint()),
        ..CauseAnswer::named(effect.name(), effect.joint(), probability)
    }
}

/// Whether a drift in time began anew in each of several runs, which neither a temperature, recorded and not a function of that
/// time, nor its look-alikes by load, all tried, explain nearly as well (docs/assumptions.md, A62).
fn is_seen_again(selection: &Selection<'_>, rivals: &[Rival], effect: &dyn Effect) -> bool {
    let context = &selection.engine().context;
    let spec = effect.spec();
    let is_tried = |name: &&str| {
        let mut tested = selection.selector.tested.iter();
        tested.any(|&index| {
            let other = selection.selector.effects[index].as_ref();
            other.name() == *name && other.joint() == effect.joint()
        })
    };
    // what is not among the rivals explains less than those, or has an impossible sign
    let is_far = |name: &&str| {
        let own = |rival: &&Rival| rival.name == *name && rival.joint == effect.joint();
        let mut same = rivals.iter().filter(own);
        same.all(|rival| rival.share < LOOK_ALIKE)
    };
    spec.family == Family::Drift
        && spec.needs.contains(&Need::Time)
        && context.runs.len() > 1
        && context.warming_k.is_some()
        && !warms_with_time(context)
        && spec
            .look_alikes
            .iter()
            .all(|name| is_tried(name) && is_far(name))
}

/// Whether a drift in time was tried in the place of one by load, or of one with a temperature that
/// follows the time.
fn is_time_tried(selector: &Selector<'_>, effect: &dyn Effect) -> bool {
    let with_temperature = effect.spec().needs.contains(&Need::Temperature);
    let in_time = |index: &usize| {
        let other = selector.effects[*index].as_ref();
        other.spec().family == Family::Drift
            && other.joint() == effect.joint()
            && other.spec().hook == effect.spec().hook
            && other.spec().needs.contains(&Need::Time)
    };
    (with_temperature && !warms_with_time(&selector.engine.context))
        || effect.spec().needs.contains(&Need::Time)
        || selector.tested.iter().any(in_time)
}

/// A term of the base model that an earlier model lacks.
fn base_term(term: &BaseTerm, total: f64, shrink: &Shrink) -> CauseAnswer {
    let hook = if term.in_drive {
        Hook::Transmission
    } else {
        Hook::Structure
    };
    let probability = SURE * TOOL_ODDS / (TOOL_ODDS + term.confusable_with.len() as f64);
    CauseAnswer {
        class_probability: SURE,
        confusable_with: term.confusable_with.clone(),
        parameters: term.parameters.clone(),
        earlier: term.earlier.clone(),
        changed: term.changed.clone(),
        share: term.explained / total.max(1e-300),
        held_out: held_out(shrink, hook, term.joint),
        ..CauseAnswer::named(term.name, term.joint, probability)
    }
}

/// What is said of the data: a number with its standard deviation.
fn finding(spec: &Spec, joint: Option<usize>, value: f64, sd: f64) -> CauseAnswer {
    let mut answer = ParameterAnswer::normal(value, sd);
    answer.ci95[0] = answer.ci95[0].max(0.0);
    CauseAnswer {
        parameters: BTreeMap::from([(spec.parameters[0].name.to_owned(), answer)]),
        ..CauseAnswer::named(spec.name, joint, DATA_PROBABILITY)
    }
}

/// Noise of another size than stated, `ratio` times as large.
pub(crate) fn noise_level(joint: Option<usize>, ratio: f64, sd: f64) -> CauseAnswer {
    finding(&NOISE_LEVEL, joint, ratio, sd)
}

/// Noise far from the stated one, and outliers: said of the data, not of the device, so they leave the
/// verdict as it is.
pub(crate) fn noise_findings(noise: &[NoiseAnswer], joints: &[Option<usize>]) -> Vec<CauseAnswer> {
    let mut found = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    for (channel, &joint) in noise.iter().zip(joints) {
        if matches!(channel.source, NoiseSource::Motion | NoiseSource::Counts)
            && (channel.ratio > LOUD || channel.speed_ratio > GROWS_WITH_SPEED)
        {
            let sd = LEVEL_SD * channel.ratio;
            found.push(noise_level(joint, channel.ratio, sd));
        }
        // a reading that stands alone is left out with all its axes: told once
        let name = channel.channel.split('.').next().unwrap_or_default();
        if channel.outlier_share > MANY_OUTLIERS && !told.contains(&name) {
            told.push(name);
            let sd = (channel.outlier_share / channel.readings.max(1) as f64).sqrt();
            found.push(finding(&OUTLIERS, joint, channel.outlier_share, sd));
        }
    }
    found
}

/// The channel in which an effect at this place shows: its external encoder where it has one, else
/// the one whose residual the causes reduce most.
fn held_out(shrink: &Shrink, hook: Hook, joint: Option<usize>) -> Option<HeldOutAnswer> {
    let own = |unseen: &&Unseen| matches!(unseen.channel, haptical_calibration::Channel::Output { joint: of } if Some(of) == joint);
    let in_encoder = matches!(hook, Hook::Transmission | Hook::ExternalEncoder);
    let by_encoder = shrink
        .channels
        .iter()
        .find(own)
        .filter(|unseen| in_encoder && unseen.gap() > SHOWN_BY_ENCODER);
    let everywhere = in_encoder || hook == Hook::Timing;
    let by_gain = || {
        let candidates = shrink
            .channels
            .iter()
            .filter(|unseen| everywhere || unseen.channel.sees_chain());
        candidates.max_by(|a, b| a.gained().total_cmp(&b.gained()))
    };
    by_encoder.or_else(by_gain).map(Unseen::answer)
}

fn confusable(rivals: &[Rival]) -> Vec<String> {
    let Some(first) = rivals.first() else {
        return vec![];
    };
    let mut names: Vec<String> = Vec::new();
    for rival in &rivals[1..] {
        if rival.nats_behind <= CONFUSABLE_NATS
            && rival.name != first.name
            && !names.iter().any(|name| name == rival.name)
        {
            names.push(rival.name.to_owned());
        }
    }
    names
}

/// The step of an event that is reported: its largest.
fn largest_step(cause: &Cause) -> usize {
    let size = |index: &usize| cause.amplitudes[*index].abs();
    (0..cause.times.len())
        .max_by(|a, b| size(a).total_cmp(&size(b)))
        .unwrap_or(0)
}

/// Amplitudes and shape as [`Effect::values`] takes them.
pub(crate) fn reported(cause: &Cause) -> (Vec<f64>, f64) {
    if cause.times.is_empty() {
        return (cause.amplitudes.clone(), cause.shape);
    }
    let largest = largest_step(cause);
    (vec![cause.amplitudes[largest]], cause.times[largest])
}

/// Intervals by the delta method, the covariate's scale and the misfit allowed for.
fn parameters(selection: &Selection<'_>, index: usize) -> BTreeMap<String, ParameterAnswer> {
    let context = &selection.engine().context;
    let causes = selection.causes();
    let cause = &causes[index];
    let effect = selection.effect(cause);
    let continuous =
        |cause: &Cause| usize::from(selection.effect(cause).spec().shape.is_continuous());
    let before: usize = causes[..index]
        .iter()
        .map(|cause| cause.amplitudes.len() + continuous(cause))
        .sum();
    let (amplitudes, shape) = reported(cause);
    let first = before + largest_step(cause);
    let count = amplitudes.len() + continuous(cause);
    let inflation = misfit(&selection.after);
    let covariance = DMatrix::from_fn(count, count, |a, b| {
        let covariance = selection.refit.covariance.as_ref();
        covariance.map_or(0.0, |all| inflation * all[(first + a, first + b)])
    });
    let values = with_variances(effect, context, &amplitudes, shape, &covariance);
    let mut answers = BTreeMap::new();
    for (spec, (value, variance)) in effect.spec().parameters.iter().zip(values) {
        let law = effect.spec().law_error.amplitude / kept(selection, cause, effect);
        let relative = match answers.is_empty() {
            true => effect.scale_uncertainty(context).hypot(law),
            false => 0.0,
        };
        let answer = match spec.role {
            Role::Instant => instant(selection, cause, value),
            _ => None,
        };
        let normal = ParameterAnswer::normal(value, variance.max(0.0).sqrt());
        let answer = answer.unwrap_or_else(|| normal.off_by_a_factor(relative));
        answers.insert(spec.name.to_owned(), answer);
    }
    if is_displacement(effect.spec()) {
        // which of several it is
        let value = cause.shape + 1.0;
        let answer = ParameterAnswer {
            value,
            ci95: [value; 2],
        };
        answers.insert("from_run".to_owned(), answer);
    }
    answers
}

/// Share of a shape that the base model does not swallow: what its law gets wrong counts the more, the
/// less of it is seen. 1 for the other kinds.
fn kept(selection: &Selection<'_>, cause: &Cause, effect: &dyn Effect) -> f64 {
    if !matches!(effect.spec().family, Family::Shape | Family::Wobble) {
        return 1.0;
    }
    let score = selection
        .first_scan
        .iter()
        .find(|score| score.effect == cause.effect);
    score.map_or(1.0, |score| score.retained.clamp(0.01, 1.0))
}

/// When the step of an event that is reported happened: between the row before the first that it may have changed, and the last.
fn instant(selection: &Selection<'_>, cause: &Cause, value: f64) -> Option<ParameterAnswer> {
    let engine = selection.engine();
    let time_s = engine.context.recording.time_s.as_ref()?;
    let step = (&selection.refit, cause, largest_step(cause));
    let effect = selection.effect(cause);
    let [first, last] = StepPlace::new(engine, effect, step, misfit(&selection.after)).rows;
    let ci95 = [time_s[first.saturating_sub(1)], time_s[last]];
    Some(ParameterAnswer { value, ci95 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_makes_a_size_wrong_but_not_its_sign() {
        for value in [3.0, -3.0] {
            let [low, high] = ParameterAnswer::normal(value, 0.01)
                .off_by_a_factor(1.5)
                .ci95;
            assert!(low * high > 0.0, "{low} {high}");
            // exp(1.96 x 1.5) is 18.9
            assert!((low.abs().max(high.abs()) / 3.0 - 18.9).abs() < 0.1);
        }
        let [low, high] = ParameterAnswer::normal(0.0, 1.0).off_by_a_factor(1e9).ci95;
        assert!((low + 1.96).abs() < 1e-12 && (high - 1.96).abs() < 1e-12);
        // where the data do not show it, it may be none
        let [low, high] = ParameterAnswer::normal(3.0, 3.0).off_by_a_factor(0.1).ci95;
        assert!(low < 0.0 && high > 8.8);
        // a small factor is a relative deviation
        let [low, high] = ParameterAnswer::normal(3.0, 0.0).off_by_a_factor(0.01).ci95;
        assert!((high - low - 2.0 * 1.96 * 0.03).abs() < 1e-3);
    }
}
