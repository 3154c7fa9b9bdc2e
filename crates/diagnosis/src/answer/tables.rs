//! Parts of the answer that are tables: gaps by channel, residuals for a picture, what was not tested, noise, steps of events.

use std::collections::BTreeMap;

use haptical_calibration::Channel;
use haptical_effects::{Context, Effect, Hook};

use crate::Result;
use crate::answer::{
    CandidateAnswer, ChannelGap, Floor, Located, NoiseAnswer, Prediction, StepAnswer, Trace,
    Untestable, channel_rms, reported,
};
use crate::engine::Cause;
use crate::judge::Findings;
use crate::select::{Rival, Selection};

/// The channels of positions and torques, with their energies over noise; `left` is what a device with the causes leaves, stream by
/// stream.
pub(crate) fn channels(findings: &Findings<'_>, left: &[Vec<f64>]) -> Vec<ChannelGap> {
    let mut gaps = position_gaps(findings, left);
    let force = &findings.force;
    if force.significant || !force.findings.is_empty() {
        gaps.extend_from_slice(&force.channels);
    }
    gaps
}

fn position_gaps(findings: &Findings<'_>, left: &[Vec<f64>]) -> Vec<ChannelGap> {
    let engine = findings.engine();
    let gap = |floor: &Floor| {
        let rms = |residual: &[Vec<f64>]| channel_rms(engine, floor.channel, residual).0;
        let sizes = [
            rms(findings.before()),
            rms(&findings.selection.refit.residual),
        ];
        let joint = match floor.channel {
            Channel::Output { joint } => Some(joint),
            _ => None,
        };
        let unit = floor.channel.unit(engine.context.device);
        let mut gap = ChannelGap::fitted(floor.channel.name(), joint, sizes, floor, unit);
        let mut unseen = findings.shrink.channels.iter();
        if let Some(seen) = unseen.find(|unseen| unseen.channel == floor.channel) {
            gap = gap.on_unseen(&seen.answer().settled(), seen.floor());
        }
        gap.rms_fit = Some(rms(left));
        gap
    };
    findings.floors.iter().map(gap).collect()
}

/// Rows of a picture at most.
const DRAWN: usize = 3000;

/// Residuals over the covariate that matters: of the rows that the fit saw, then of those that it did not.
pub(crate) fn traces(findings: &Findings<'_>, located: Option<&Located>) -> Result<Vec<Trace>> {
    let Some(located) = located else {
        return Ok(vec![]);
    };
    let seen = seen(findings, located).into_iter();
    Ok(seen.chain(unseen(findings, located)?).collect())
}

fn seen(findings: &Findings<'_>, located: &Located) -> Option<Trace> {
    let engine = findings.engine();
    let at = located.covariate.values(&engine.context)?;
    let stream = located.stream;
    let usable: Vec<usize> = (0..at.len())
        .filter(|&row| engine.usable[stream][row] && at[row].is_finite())
        .collect();
    let step = usable.len().div_ceil(DRAWN).max(1);
    let rows: Vec<usize> = usable.into_iter().step_by(step).collect();
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect();
    Some(Trace {
        channel: engine.context.streams[stream].name(),
        unit: engine.context.streams[stream].unit.to_owned(),
        covariate: located.covariate.column(&engine.context),
        is_held_out: false,
        at: pick(&at),
        before: pick(&findings.before()[stream]),
        after: pick(&findings.selection.refit.residual[stream]),
    })
}

/// What the predictions of a second recording, or of held-out rows, leave.
fn unseen(findings: &Findings<'_>, located: &Located) -> Result<Option<Trace>> {
    let engine = findings.engine();
    let stream = &engine.context.streams[located.stream];
    let values = match findings.inputs.options.validation {
        Some(second) => {
            let context = Context::new(&engine.base.device, second, &engine.context.streams)?;
            located.covariate.values(&context)
        }
        None => located.covariate.values(&engine.context),
    };
    let (name, predictions) = (stream.name(), &findings.shrink.predictions);
    let Some(values) = values else {
        return Ok(None);
    };
    let of_stream: Vec<&Prediction> = predictions
        .iter()
        .filter(|one| one.channel == name && values.get(one.row).is_some_and(|at| at.is_finite()))
        .collect();
    let step = of_stream.len().div_ceil(DRAWN).max(1);
    let drawn: Vec<&Prediction> = of_stream.into_iter().step_by(step).collect();
    if drawn.is_empty() {
        return Ok(None);
    }
    let pick = |value: &dyn Fn(&Prediction) -> f64| drawn.iter().map(|one| value(one)).collect();
    Ok(Some(Trace {
        channel: name,
        unit: stream.unit.to_owned(),
        covariate: located.covariate.column(&engine.context),
        is_held_out: true,
        at: pick(&|one| values[one.row]),
        before: pick(&|one| one.measured - one.before),
        after: pick(&|one| one.measured - one.after),
    }))
}

pub(crate) fn untestable(findings: &Findings<'_>) -> Vec<Untestable> {
    let mut found: Vec<Untestable> = Vec::new();
    for effect in findings.selection.selector.effects {
        let Some(why) = effect.untestable(&findings.engine().context) else {
            continue;
        };
        let why = general(effect.as_ref(), why);
        Untestable::add(&mut found, effect.name(), effect.joint(), why);
    }
    found.extend(of_further_cables(findings));
    found.extend(findings.force.untestable.iter().cloned());
    found
}

/// Effects of a cable that are looked for on the first one alone.
fn of_further_cables(findings: &Findings<'_>) -> Vec<Untestable> {
    let context = &findings.engine().context;
    let mut channels = context.streams.iter().map(|stream| stream.channel);
    let has_further = channels.any(|own| matches!(own, Channel::Cable { index } if index > 0));
    let effects = findings.selection.selector.effects;
    let is_of_first = |effect: &&dyn Effect| {
        let mut same = effects.iter().filter(|other| other.name() == effect.name());
        effect.spec().hook == Hook::CableSensor && same.all(|own| own.further_cable().is_none())
    };
    let all = effects.iter().map(AsRef::as_ref);
    let of_first = all.filter(|_| has_further).filter(is_of_first);
    let why = "looked for in cable_m alone, not in cable2_m and further ones";
    of_first
        .map(|effect| Untestable::new(effect.name(), why))
        .collect()
}

/// The reason without the joint's number, so that joints with the same reason share a line.
fn general(effect: &dyn Effect, why: String) -> String {
    match effect.joint() {
        Some(joint) => why
            .replace(&format!("torque{}_n", joint + 1), "torque*_n")
            .replace(&format!("out{}_rad", joint + 1), "out*_rad"),
        None => why,
    }
}

pub(crate) fn noise(findings: &Findings<'_>) -> Vec<NoiseAnswer> {
    let engine = findings.engine();
    let streams = engine.context.streams.iter().zip(&engine.noise).enumerate();
    streams
        .map(|(index, (stream, noise))| {
            let left_out = findings
                .inputs
                .gone
                .iter()
                .filter(|(channel, _)| *channel == stream.channel)
                .count();
            let kept = engine.usable[index]
                .iter()
                .filter(|usable| **usable)
                .count();
            NoiseAnswer {
                channel: stream.name(),
                ratio: noise.ratio,
                speed_ratio: noise.speed_ratio,
                readings: kept,
                degrees_of_freedom: noise.freedom,
                source: noise.source,
                colour: noise.colour * noise.coloured_share,
                outlier_share: left_out as f64 / (kept + left_out).max(1) as f64,
                from: noise.source.words().to_owned(),
            }
        })
        .collect()
}

/// The numbers of a cause by name, those of its law besides the reported ones among them.
fn numbers_of(effect: &dyn Effect, cause: &Cause, context: &Context<'_>) -> BTreeMap<String, f64> {
    let (amplitudes, shape) = reported(cause);
    let spec = effect.spec();
    let values = effect.values(context, &amplitudes, shape);
    let named = spec.parameters.iter().map(|own| own.name).zip(values);
    let further = effect.further(context, &amplitudes, shape);
    let further = spec.further.iter().map(|own| own.name).zip(further);
    named
        .chain(further)
        .filter(|(_, value)| value.is_finite())
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// Candidates for the first cause.
pub(crate) fn candidates(findings: &Findings<'_>) -> Vec<CandidateAnswer> {
    let rivals = findings.rivals.first().into_iter().flatten().take(8);
    let context = &findings.engine().context;
    let own = findings.selection.causes().first();
    let numbers = |place: usize, rival: &Rival| {
        // the cause itself comes first, and is no rival that was fitted anew
        let fitted = rival.cause.as_ref().or(own.filter(|_| place == 0));
        fitted.map_or_else(BTreeMap::new, |cause| {
            numbers_of(findings.selection.effect(cause), cause, context)
        })
    };
    let mut found: Vec<CandidateAnswer> = rivals
        .enumerate()
        .map(|(place, rival)| CandidateAnswer {
            parameters: match rival.has_converged {
                true => numbers(place, rival),
                false => BTreeMap::new(),
            },
            refused: (!rival.has_converged).then(|| NOT_CONVERGED.to_owned()),
            effect: rival.name.to_owned(),
            joint: rival.joint.map(|joint| joint + 1),
            share: rival.share,
            nats_behind: rival.nats_behind,
            probability: rival.probability,
        })
        .collect();
    found.extend(unconverged(findings, &found));
    found
}

/// Contenders whose fits ended at no minimum, those that are in the list already left out.
fn unconverged(findings: &Findings<'_>, listed: &[CandidateAnswer]) -> Vec<CandidateAnswer> {
    let selection = &findings.selection;
    let first = selection.first_scan.first();
    let most = first.map_or(f64::INFINITY, |first| first.score);
    let scores = selection.unconverged.iter();
    let answers = scores.map(|score| {
        let effect = selection.selector.effects[score.effect].as_ref();
        let behind = first.map_or(0.0, |first| {
            selection.selector.criterion(first) - selection.selector.criterion(score)
        });
        CandidateAnswer {
            effect: effect.name().to_owned(),
            joint: effect.joint().map(|joint| joint + 1),
            share: (score.score / most).min(1.0),
            nats_behind: behind.max(0.0),
            probability: 0.0,
            parameters: BTreeMap::new(),
            refused: Some(NOT_CONVERGED.to_owned()),
        }
    });
    let is_new = |own: &CandidateAnswer| {
        let mut others = listed.iter();
        !others.any(|other| other.effect == own.effect && other.joint == own.joint)
    };
    answers.filter(is_new).collect()
}

/// Why a candidate has no numbers.
const NOT_CONVERGED: &str = "fit did not converge";

/// Every step of every cause that is an event.
pub(crate) fn steps(selection: &Selection<'_>) -> Vec<StepAnswer> {
    let mut steps = Vec::new();
    for cause in selection.causes() {
        let effect = selection.effect(cause);
        for (time, size) in cause.times.iter().zip(&cause.amplitudes) {
            steps.push(StepAnswer {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                first_row: [*time as usize; 2],
                size: *size,
            });
        }
    }
    steps
}
