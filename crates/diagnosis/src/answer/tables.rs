//! Parts of the answer that are tables: gaps by channel, residuals for a picture, what was not tested, noise.

use haptical_calibration::Channel;
use haptical_effects::Effect;
use haptical_metrics::gap_reduction_percent;

use crate::answer::place::Located;
use crate::answer::shrink::{Shrink, Unseen};
use crate::answer::{ChannelGap, NoiseAnswer, Trace, Untestable};
use crate::force::answer::ForceAnswer;
use crate::select::{Selection, Selector};

pub(crate) fn channel_gaps(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    before: &[Vec<f64>],
    shrink: &Shrink,
) -> Vec<ChannelGap> {
    let engine = selector.engine;
    let context = &engine.context;
    let mut channels: Vec<Channel> = context.streams.iter().map(|s| s.channel).collect();
    channels.dedup();
    channels
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
            let seen = seen.map(Unseen::answer);
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
        .collect()
}

/// The channels of positions and torques, with shares that add up to 1, of energies over noise; all 0 where there is
/// no energy.
pub(crate) fn shared(mut gaps: Vec<ChannelGap>, force: &ForceAnswer) -> Vec<ChannelGap> {
    gaps.extend(torque_gaps(force));
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

/// The torques, where they show a gap.
fn torque_gaps(force: &ForceAnswer) -> Vec<ChannelGap> {
    if force.findings.is_empty() && !force.significant {
        return vec![];
    }
    let gaps = force.channels.iter().map(|gap| ChannelGap {
        channel: format!("torque{}", gap.joint + 1),
        joint: Some(gap.joint + 1),
        rms_before: gap.rms_before,
        rms_after: gap.rms_after,
        noise_floor: gap.noise_floor,
        unit: "N m".to_owned(),
        share_of_gap: gap.excess(),
        reduction_percent: gap_reduction_percent(gap.rms_before, gap.rms_after, gap.noise_floor),
        reduction_ci95: None,
    });
    gaps.collect()
}

/// Rows of a picture at most.
const DRAWN: usize = 3000;

pub(crate) fn traces(
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

pub(crate) fn untestable(
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

pub(crate) fn noise(selector: &Selector<'_, '_>, gone: &[(Channel, usize)]) -> Vec<NoiseAnswer> {
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
