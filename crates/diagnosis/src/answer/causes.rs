//! Causes as they are answered: names, probabilities, parameters with intervals, shrink.

use std::collections::BTreeMap;

use haptical_effects::noise::{NOISE_LEVEL, OUTLIERS};
use haptical_effects::{Effect, Family, Hook, Need, Role, Spec};

use crate::answer::shrink::{Shrink, Unseen};
use crate::answer::{CauseAnswer, HeldOutAnswer, NoiseAnswer, ParameterAnswer};
use crate::engine::model::{Cause, Refit};
use crate::force::answer::ForceAnswer;
use crate::judge::adequacy::Adequacy;
use crate::judge::earlier::BaseTerm;
use crate::judge::rivals::{Rival, warms_with_time};
use crate::select::{Selection, Selector, misfit};
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::earlier_model::{SURE, TOOL_ODDS};
use crate::thresholds::noise::{DATA_PROBABILITY, LEVEL_SD};
use crate::thresholds::noise::{GROWS_WITH_SPEED, LOUD, MANY_OUTLIERS};
use crate::thresholds::rivals::{SETTLING, STEADY};
use crate::thresholds::unseen::SHOWN_BY_ENCODER;

/// One cause of a selection.
pub(crate) fn cause_answer(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    index: usize,
    rivals: &[Rival],
    adequacy: &Adequacy,
    total: f64,
    shrink: &Shrink,
) -> CauseAnswer {
    let cause = &selection.refit.model.causes[index];
    let effect = selector.effects[cause.effect].as_ref();
    let (amplitudes, shape) = reported(cause);
    let values = effect.values(&selector.engine.context, &amplitudes, shape);
    let confusable = confusable(rivals);
    let own = rivals.first().map_or(1.0, |rival| rival.probability);
    let mut probability = own * (1.0 - adequacy.doubt());
    // a drift that settles has no law of its own: many things settle
    if effect.spec().family == Family::Drift && cause.shape != 0.0 {
        probability *= SETTLING;
    } else if effect.spec().family == Family::Drift && !effect.spec().look_alikes.is_empty() {
        // a cable that creeps under a steady load drifts as steadily
        probability *= STEADY;
    } else if effect.spec().family == Family::Drift
        && confusable.is_empty()
        && !is_time_tried(selector, effect)
    {
        // a law of time, which was not tried, may have the same course
        probability *= STEADY;
    }
    let class: f64 = rivals
        .iter()
        .filter(|rival| rival.nats_behind <= CONFUSABLE_NATS)
        .map(|rival| rival.probability)
        .sum();
    CauseAnswer {
        effect: effect.name().to_owned(),
        joint: effect.joint().map(|joint| joint + 1),
        class_probability: (class * (1.0 - adequacy.doubt())).max(probability),
        probability,
        confusable_with: confusable,
        parameters: parameters(selector, selection, index),
        plausible: effect.is_plausible(&values),
        implausible: !effect.is_plausible(&values),
        share: selection.explained[index] / total.max(1e-300),
        held_out: held_out(shrink, effect.spec().hook, effect.joint()),
    }
}

/// Whether a drift in time was tried in the place of one by load, or of one with a temperature that
/// follows the time.
fn is_time_tried(selector: &Selector<'_, '_>, effect: &dyn Effect) -> bool {
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
pub(crate) fn base_term(term: &BaseTerm, total: f64, shrink: &Shrink) -> CauseAnswer {
    let hook = if term.in_drive {
        Hook::Transmission
    } else {
        Hook::Structure
    };
    CauseAnswer {
        effect: term.name.to_owned(),
        joint: term.joint.map(|joint| joint + 1),
        class_probability: SURE,
        probability: SURE * TOOL_ODDS / (TOOL_ODDS + term.confusable_with.len() as f64),
        confusable_with: term.confusable_with.clone(),
        parameters: term.parameters.clone(),
        plausible: true,
        implausible: false,
        share: term.explained / total.max(1e-300),
        held_out: held_out(shrink, hook, term.joint),
    }
}

/// What is said of the data: a number with its standard deviation.
fn finding(spec: &Spec, joint: Option<usize>, value: f64, sd: f64) -> CauseAnswer {
    CauseAnswer {
        effect: spec.name.to_owned(),
        joint: joint.map(|joint| joint + 1),
        class_probability: DATA_PROBABILITY,
        probability: DATA_PROBABILITY,
        confusable_with: Vec::new(),
        parameters: BTreeMap::from([(
            spec.parameters[0].name.to_owned(),
            ParameterAnswer {
                value,
                ci95: [(value - 1.96 * sd).max(0.0), value + 1.96 * sd],
            },
        )]),
        plausible: true,
        implausible: false,
        share: 0.0,
        held_out: None,
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
        if channel.from_motion && (channel.ratio > LOUD || channel.speed_ratio > GROWS_WITH_SPEED) {
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

/// Effects on torques and forces, which no position shows.
pub(crate) fn force_findings(force: &ForceAnswer) -> Vec<CauseAnswer> {
    let findings = force.findings.iter();
    findings
        .map(|finding| {
            let probability = finding.probability * 0.97;
            CauseAnswer {
                effect: finding.effect.to_owned(),
                joint: finding.joint.map(|joint| joint + 1),
                probability,
                class_probability: probability,
                confusable_with: finding
                    .confusable_with
                    .iter()
                    .map(|name| name.split('@').next().unwrap_or(name).to_owned())
                    .filter(|name| name != finding.effect)
                    .collect(),
                parameters: finding
                    .parameters
                    .iter()
                    .map(|(name, value, ci95)| {
                        let answer = ParameterAnswer {
                            value: *value,
                            ci95: *ci95,
                        };
                        (name.clone(), answer)
                    })
                    .collect(),
                plausible: finding.plausible,
                implausible: !finding.plausible,
                share: finding.share,
                held_out: None,
            }
        })
        .collect()
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
    let by_gain = || {
        let candidates = shrink
            .channels
            .iter()
            .filter(|unseen| in_encoder || unseen.channel.sees_chain());
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
fn reported(cause: &Cause) -> (Vec<f64>, f64) {
    if cause.times.is_empty() {
        return (cause.amplitudes.clone(), cause.shape);
    }
    let largest = largest_step(cause);
    (vec![cause.amplitudes[largest]], cause.times[largest])
}

/// Variances and covariances of one cause's numbers within a refit.
struct Spread<'r> {
    refit: &'r Refit,
    first: usize,
    count: usize,
    /// What misfit adds to the variances.
    inflation: f64,
}

impl Spread<'_> {
    fn entry(&self, a: usize, b: usize) -> f64 {
        let covariance = self.refit.covariance.as_ref();
        covariance.map_or(0.0, |c| {
            self.inflation * c[(self.first + a, self.first + b)]
        })
    }
}

/// Intervals by the delta method, the covariate's scale and the misfit allowed for.
fn parameters(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    index: usize,
) -> BTreeMap<String, ParameterAnswer> {
    let context = &selector.engine.context;
    let causes = &selection.refit.model.causes;
    let cause = &causes[index];
    let effect = selector.effects[cause.effect].as_ref();
    let continuous =
        |cause: &Cause| usize::from(selector.effects[cause.effect].spec().shape.is_continuous());
    let before: usize = causes[..index]
        .iter()
        .map(|cause| cause.amplitudes.len() + continuous(cause))
        .sum();
    let (amplitudes, shape) = reported(cause);
    let values = effect.values(context, &amplitudes, shape);
    let spread = Spread {
        refit: &selection.refit,
        first: before + largest_step(cause),
        count: amplitudes.len() + continuous(cause),
        inflation: misfit(&selection.after),
    };
    let slopes = slopes(selector, effect, &amplitudes, shape, &spread);
    let mut answers = BTreeMap::new();
    for (position, (spec, &value)) in effect.spec().parameters.iter().zip(&values).enumerate() {
        let mut variance = 0.0;
        for a in 0..spread.count {
            for b in 0..spread.count {
                variance += slopes[position][a] * spread.entry(a, b) * slopes[position][b];
            }
        }
        if position == 0 {
            let law = effect.spec().law_error.amplitude / kept(selection, cause, effect);
            let relative = effect.scale_uncertainty(context).hypot(law);
            variance += (value * relative).powi(2);
        }
        let mut half = 1.96 * variance.max(0.0).sqrt();
        if spec.role == Role::Instant {
            half = half.max(instant_uncertainty_s(selector, shape));
        }
        answers.insert(
            spec.name.to_owned(),
            ParameterAnswer {
                value,
                ci95: [value - half, value + half],
            },
        );
    }
    answers
}

/// Share of a shape that the base model does not swallow: what its law gets wrong counts the more, the
/// less of it is seen. 1 for the other kinds.
fn kept(selection: &Selection, cause: &Cause, effect: &dyn Effect) -> f64 {
    if !matches!(effect.spec().family, Family::Shape | Family::Wobble) {
        return 1.0;
    }
    let score = selection
        .first_scan
        .iter()
        .find(|score| score.effect == cause.effect);
    score.map_or(1.0, |score| score.retained.clamp(0.01, 1.0))
}

/// An instant is known to a few blocks of rows.
fn instant_uncertainty_s(selector: &Selector<'_, '_>, row: f64) -> f64 {
    let context = &selector.engine.context;
    let Some(times) = &context.recording.time_s else {
        return 0.0;
    };
    let row = (row as usize).min(times.len() - 1);
    let reach = 2 * selector.engine.system.layout.size;
    let (first, last) = (
        row.saturating_sub(reach),
        (row + reach).min(times.len() - 1),
    );
    (times[last] - times[first]).abs() / 2.0
}

/// Derivative of every reported value with respect to amplitudes and logarithm of the shape.
fn slopes(
    selector: &Selector<'_, '_>,
    effect: &dyn Effect,
    amplitudes: &[f64],
    shape: f64,
    spread: &Spread<'_>,
) -> Vec<Vec<f64>> {
    let context = &selector.engine.context;
    let values = effect.values(context, amplitudes, shape);
    let mut slopes = vec![vec![0.0; spread.count]; values.len()];
    for number in 0..spread.count {
        let sd = spread.entry(number, number).max(0.0).sqrt();
        let (mut amplitudes, mut shape) = (amplitudes.to_vec(), shape);
        let step = match amplitudes.get_mut(number) {
            Some(amplitude) => {
                let step = (1e-3 * sd).max(1e-9 * amplitude.abs()).max(1e-300);
                *amplitude += step;
                step
            }
            None => {
                shape *= 1e-4_f64.exp();
                1e-4
            }
        };
        let moved = effect.values(context, &amplitudes, shape);
        for (row, (after, before)) in slopes.iter_mut().zip(moved.iter().zip(&values)) {
            row[number] = (after - before) / step;
        }
    }
    slopes
}
