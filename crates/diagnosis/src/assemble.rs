//! Puts the answer together from a selection.

use haptical_calibration::Channel;
use haptical_metrics::gap_reduction_percent;
use haptical_model::{Device, Recording};

use crate::adequacy::{Adequacy, adequacy};
use crate::advice::next_experiment;
use crate::answer::{
    CandidateAnswer, CauseAnswer, ChannelGap, Diagnosis, Gap, NoiseAnswer, Provenance, Trace,
    Untestable, Verdict,
};
use crate::base::Base;
use crate::catalogue::Effect;
use crate::causes::{base_term, cause_answer, force_findings, noise_findings};
use crate::earlier::{Difference, difference};
use crate::force::answer::ForceAnswer;
use crate::place::{Located, locate, of_base_term};
use crate::rivals::{Rival, settle};
use crate::select::{Selection, Selector};
use crate::shrink::{Shrink, model_residual, on_held_back, on_second};
use crate::unseen::{hints, unseen};
use crate::{DiagnosisError, Options};

/// What the answer is put together from.
#[derive(Clone, Copy)]
pub(crate) struct Inputs<'i> {
    pub(crate) nominal: &'i Device,
    pub(crate) recording: &'i Recording,
    /// Readings left out as outliers.
    pub(crate) gone: &'i [(Channel, usize)],
    /// Effects that the base model has already.
    pub(crate) in_base: &'i [usize],
    /// The model identified earlier.
    pub(crate) earlier: Option<&'i Base>,
    pub(crate) options: &'i Options<'i>,
}

pub(crate) fn assemble(
    selector: &mut Selector<'_, '_>,
    selection: &mut Selection,
    inputs: &Inputs<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let rivals = settle(selector, selection)?;
    let selection = &*selection;
    let engine = selector.engine;
    let adequacy = adequacy(selector, selection);
    let earlier_residual = match inputs.earlier {
        Some(model) => Some(model_residual(model, inputs.recording, engine)?),
        None => None,
    };
    let base_terms = match &earlier_residual {
        Some(residual) => difference(engine, residual),
        None => Difference::default(),
    };
    let shrink = shrink(
        selector,
        selection,
        inputs,
        &base_terms,
        earlier_residual.as_deref(),
    )?;
    let total: f64 = selection.explained.iter().sum::<f64>() + base_terms.total;
    let mut causes: Vec<CauseAnswer> = base_terms
        .terms
        .iter()
        .map(|term| base_term(term, total, &shrink))
        .collect();
    for (index, list) in rivals.iter().enumerate() {
        let answer = cause_answer(selector, selection, index, list, &adequacy, total, &shrink);
        causes.push(answer);
    }
    let mut first = true;
    causes
        .retain(|cause| std::mem::take(&mut first) || cause.class_probability >= LATER_PROBABILITY);
    if !base_terms.terms.is_empty() {
        causes.sort_by(|a, b| b.share.total_cmp(&a.share));
    }
    let mut verdict = verdict(selector, selection, &adequacy, &causes);
    let force = crate::force::examine(&engine.context)?;
    let on_forces = force_findings(&force, &inputs.options.without);
    if let (Verdict::NoGap, Some(first)) = (verdict, on_forces.first()) {
        let sure = first.probability >= selector.thresholds.named_probability;
        verdict = if sure {
            Verdict::Named
        } else {
            Verdict::Ambiguous
        };
    }
    causes.extend(on_forces);
    let located = match verdict {
        Verdict::NoGap => None,
        _ => match base_terms.terms.first() {
            Some(term) if verdict != Verdict::Unknown => of_base_term(engine, term),
            _ => locate(selector, selection, adequacy.is_adequate),
        },
    };
    let noise = noise(selector, inputs.gone);
    let joints: Vec<Option<usize>> = engine
        .context
        .streams
        .iter()
        .map(crate::context::Stream::joint)
        .collect();
    // next to a gap, what its effect leaves in fast motion would pass for noise
    if causes.is_empty() {
        causes.extend(noise_findings(&noise, &joints));
    }
    let before = earlier_residual.as_ref().unwrap_or(&engine.start.residual);
    let (detectable, invisible) = unseen(selector, inputs.in_base);
    let first = selection.refit.model.causes.first();
    let first_effect = first.map(|cause| selector.effects[cause.effect].as_ref());
    let confused = causes
        .first()
        .map_or(&[][..], |cause| &cause.confusable_with);
    let mut warnings = shrink.warnings.clone();
    warnings.extend(implausible(&causes));
    Ok(Diagnosis {
        verdict,
        gap: Gap {
            channels: [
                channel_gaps(selector, selection, before, &shrink),
                torque_gaps(&force),
            ]
            .concat(),
        },
        next_experiment: next_experiment(verdict, first_effect, confused, located.as_ref()),
        traces: traces(selector, selection, before, located.as_ref()),
        place: located.map(|located| located.answer),
        unexplained_share: if verdict == Verdict::NoGap {
            0.0
        } else {
            adequacy.unexplained
        },
        probability_unknown: adequacy.probability_unknown(verdict),
        causes,
        untestable: untestable(selector, &force.untestable),
        invisible,
        detectable,
        noise,
        candidates: rivals
            .first()
            .map(|list| candidates(list))
            .unwrap_or_default(),
        plausibility: hints(engine, inputs.nominal),
        warnings,
        held_out: shrink.description,
        provenance: Provenance {
            rows: inputs.recording.len(),
            base_parameters: engine.base.parameters.len(),
            base_identifiable: engine.base.free.len(),
            tested: selector.tested.len(),
            thresholds: selector.thresholds.version.clone(),
            last_step: engine.start.last_step,
            without: inputs.options.without.clone(),
        },
        device: engine.problem.device_with(&engine.start.model.values),
        predictions: shrink.predictions,
    })
}

fn shrink(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    inputs: &Inputs<'_>,
    base_terms: &Difference,
    earlier_residual: Option<&[Vec<f64>]>,
) -> Result<Shrink, DiagnosisError> {
    match inputs.options.validation {
        Some(second) => on_second(
            selector,
            selection,
            second,
            selector.thresholds.outlier_sd,
            inputs.earlier,
        ),
        None if selection.refit.model.causes.is_empty() && base_terms.terms.is_empty() => {
            Ok(Shrink::default())
        }
        None => on_held_back(selector, selection, inputs.recording, earlier_residual),
    }
}

fn verdict(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    adequacy: &Adequacy,
    causes: &[CauseAnswer],
) -> Verdict {
    let thresholds = selector.thresholds;
    let found = !selection.refit.model.causes.is_empty();
    if !found {
        let quiet = adequacy.worst < thresholds.omnibus_z && selection.refused.is_none();
        return match (quiet, causes.is_empty()) {
            (true, true) => Verdict::NoGap,
            (true, false) => Verdict::Named,
            (false, _) => Verdict::Unknown,
        };
    }
    let hedged = causes
        .first()
        .is_some_and(|cause| cause.confusable_with.len() >= thresholds.names);
    if !adequacy.is_adequate || hedged {
        return Verdict::Unknown;
    }
    let sure = causes
        .first()
        .is_some_and(|cause| cause.probability >= thresholds.named_probability);
    if sure {
        Verdict::Named
    } else {
        Verdict::Ambiguous
    }
}

fn implausible(causes: &[CauseAnswer]) -> Vec<String> {
    causes
        .iter()
        .filter(|cause| !cause.plausible)
        .map(|cause| {
            format!(
                "{} at {} has a size that no sound device shows: check the units and signs of the log, or look for \
                 damage",
                cause.effect,
                cause.joint.map_or("the device".to_owned(), |joint| format!("joint {joint}"))
            )
        })
        .collect()
}

fn candidates(rivals: &[Rival]) -> Vec<CandidateAnswer> {
    rivals
        .iter()
        .take(8)
        .map(|rival| CandidateAnswer {
            effect: rival.name.to_owned(),
            joint: rival.joint.map(|joint| joint + 1),
            share: rival.share,
            nats_behind: rival.nats_behind,
            probability: rival.probability,
        })
        .collect()
}

fn channel_gaps(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    before: &[Vec<f64>],
    shrink: &Shrink,
) -> Vec<ChannelGap> {
    let engine = selector.engine;
    let context = &engine.context;
    let mut channels: Vec<Channel> = context.streams.iter().map(|s| s.channel).collect();
    channels.dedup();
    let mut gaps: Vec<ChannelGap> = channels
        .into_iter()
        .map(|channel| {
            let streams: Vec<usize> = (0..context.streams.len())
                .filter(|&stream| context.streams[stream].channel == channel)
                .collect();
            let rms = |residual: &[Vec<f64>]| {
                let values = streams.iter().flat_map(|&stream| {
                    let usable = &engine.usable[stream];
                    let pairs = residual[stream].iter().zip(usable);
                    pairs
                        .filter(|(_, usable)| **usable)
                        .map(|(value, _)| *value)
                });
                let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| {
                    (sum + value * value, count + 1.0)
                });
                if count > 0.0 {
                    f64::sqrt(sum / count)
                } else {
                    0.0
                }
            };
            let noise_floor = (streams
                .iter()
                .map(|&s| engine.floor[s].powi(2))
                .sum::<f64>()
                / streams.len().max(1) as f64)
                .sqrt();
            let (rms_before, rms_after) = (rms(before), rms(&selection.refit.residual));
            let seen = shrink
                .channels
                .iter()
                .find(|unseen| unseen.channel == channel);
            let seen = seen.map(crate::shrink::Unseen::answer);
            ChannelGap {
                channel: channel.name(),
                joint: match channel {
                    Channel::Output { joint } => Some(joint + 1),
                    _ => None,
                },
                rms_before,
                rms_after,
                noise_floor,
                unit: channel.unit(context.device).to_owned(),
                share_of_gap: ((rms_before / noise_floor).powi(2) - 1.0).max(0.0),
                reduction_percent: seen.as_ref().map_or_else(
                    || gap_reduction_percent(rms_before, rms_after, noise_floor),
                    |seen| seen.reduction_percent,
                ),
                reduction_ci95: seen.and_then(|seen| seen.reduction_ci95),
            }
        })
        .collect();
    let total: f64 = gaps.iter().map(|gap| gap.share_of_gap).sum();
    for gap in &mut gaps {
        gap.share_of_gap = if total > 0.0 {
            gap.share_of_gap / total
        } else {
            0.0
        };
    }
    gaps
}

/// Probability below which a later cause is not told: it is what an earlier one's law gets wrong.
const LATER_PROBABILITY: f64 = 0.6;
/// The torques, where an effect on them was found.
fn torque_gaps(force: &ForceAnswer) -> Vec<ChannelGap> {
    if force.findings.is_empty() {
        return vec![];
    }
    let gaps = force.channels.iter().map(|gap| ChannelGap {
        channel: format!("torque{}", gap.joint + 1),
        joint: Some(gap.joint + 1),
        rms_before: gap.rms_before,
        rms_after: gap.rms_after,
        noise_floor: gap.noise_floor,
        unit: "N m".to_owned(),
        share_of_gap: 0.0,
        reduction_percent: gap_reduction_percent(gap.rms_before, gap.rms_after, gap.noise_floor),
        reduction_ci95: None,
    });
    gaps.collect()
}

/// Rows of a picture at most.
const DRAWN: usize = 3000;

fn traces(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    before: &[Vec<f64>],
    located: Option<&Located>,
) -> Vec<Trace> {
    let engine = selector.engine;
    let Some(located) = located else {
        return vec![];
    };
    let Some(at) = located.covariate.values(&engine.context) else {
        return vec![];
    };
    let stream = located.stream;
    let usable: Vec<usize> = (0..at.len())
        .filter(|&row| engine.usable[stream][row] && at[row].is_finite())
        .collect();
    let step = usable.len().div_ceil(DRAWN).max(1);
    let rows: Vec<usize> = usable.into_iter().step_by(step).collect();
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect();
    vec![Trace {
        channel: engine.context.streams[stream].name(),
        unit: engine.context.streams[stream].unit.to_owned(),
        covariate: located.covariate.column(&engine.context),
        at: pick(&at),
        before: pick(&before[stream]),
        after: pick(&selection.refit.residual[stream]),
    }]
}

fn untestable(
    selector: &Selector<'_, '_>,
    on_forces: &[(&'static str, String)],
) -> Vec<Untestable> {
    let mut found: Vec<Untestable> = Vec::new();
    for effect in selector.effects {
        let Some(why) = effect.untestable(&selector.engine.context) else {
            continue;
        };
        let why = general(effect.as_ref(), why);
        let joint = effect.joint().map(|joint| joint + 1);
        match found
            .iter_mut()
            .find(|entry| entry.effect == effect.name() && entry.why == why)
        {
            Some(entry) => entry
                .joints
                .extend(joint.filter(|joint| !entry.joints.contains(joint))),
            None => found.push(Untestable {
                effect: effect.name().to_owned(),
                joints: joint.into_iter().collect(),
                why,
            }),
        }
    }
    found.extend(on_forces.iter().map(|(effect, why)| Untestable {
        effect: (*effect).to_owned(),
        joints: Vec::new(),
        why: why.clone(),
    }));
    found
}

/// The reason without the joint's number, so that joints with the same reason share a line.
fn general(effect: &dyn Effect, why: String) -> String {
    match effect.joint() {
        Some(joint) => why
            .replace(&format!("torque{}_nm", joint + 1), "torque*_nm")
            .replace(&format!("out{}_rad", joint + 1), "out*_rad"),
        None => why,
    }
}

fn noise(selector: &Selector<'_, '_>, gone: &[(Channel, usize)]) -> Vec<NoiseAnswer> {
    let engine = selector.engine;
    let streams = engine.context.streams.iter().zip(&engine.noise).enumerate();
    streams
        .map(|(index, (stream, noise))| {
            let left_out = gone
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
                from_motion: noise.from_motion,
                colour: noise.colour * noise.coloured_share,
                outlier_share: left_out as f64 / (kept + left_out).max(1) as f64,
                from: if !noise.from_motion && noise.ratio == 1.0 {
                    "the device file".to_owned()
                } else if noise.from_motion {
                    "differences of successive rows".to_owned()
                } else {
                    "all that the model leaves".to_owned()
                },
            }
        })
        .collect()
}
