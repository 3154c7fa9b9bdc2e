//! A drive that gives less than the torque that is logged.

use std::rc::Rc;

use super::{Candidate, Context, Effect, ends};
use crate::select::Pick;
use crate::thresholds::effect::{
    ABOVE_SDS, DENSER_AT_END, END_SDS, LEAST_FLAT, LONGEST_SATURATION, MOST_ABOVE,
    MOST_MISSING_NODES, NEAR_ALL, NEAR_END_SDS, RIGHT_SIDE, SATURATION_LIMITS,
};

pub(super) const EFFECT: Effect = Effect::new("torque-saturation", candidates).of_own_joint();

/// The law of a reading that ends, among this effect's.
const CLIPPED: usize = 1;

/// Joint and torque \[N m, N\] at which a pick says that readings end.
pub(crate) fn ends_at(pick: &Pick) -> Option<(usize, f64)> {
    let is_clipped = pick.effect == EFFECT.name && pick.kind == CLIPPED;
    is_clipped.then_some((pick.joint?, *pick.shape.first()?))
}

fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let [low, high] = ends(&context.problem.recorded_torque(joint));
        let limits = SATURATION_LIMITS.map(|share| share * high.max(-low));
        let mut found: Vec<Candidate<'_>> = clipped(context, joint).into_iter().collect();
        let lost = limits.into_iter();
        found.extend(lost.filter_map(|limit| at(context, joint, limit)));
        found
    })
}

/// A reading that ends: it stands at its largest value, but for noise, and says there less than there is. What is missing is free,
/// straight between nodes.
fn clipped(context: Context<'_>, joint: usize) -> Option<Candidate<'_>> {
    let problem = context.problem;
    let states = &problem.states;
    let pieces = problem
        .samples
        .pieces
        .iter()
        .filter_map(|own| own.torque[joint].as_ref());
    let all: Vec<f64> = pieces.flatten().copied().collect();
    let most = all.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let sd = problem.reading_sd[problem.channel_of(joint)?].max(1e-9 * most);
    let end = end(&all, sd)?;
    let smooth = problem.recorded_torque(joint);
    // where a smoothed reading is near its end, the low pass takes in readings that ended
    let near: Vec<bool> = smooth
        .iter()
        .map(|own| own.abs() > end - NEAR_END_SDS * sd)
        .collect();
    let times = near
        .iter()
        .zip(&states.time_s)
        .filter(|(near, _)| **near)
        .map(|(_, time)| *time);
    let times: Vec<f64> = times.collect();
    let apart_s = states
        .pass
        .row_s()
        .max(times.len() as f64 * states.fine_s / MOST_MISSING_NODES as f64);
    let mut nodes: Vec<f64> = Vec::new();
    for time in times {
        let node = (time / apart_s).round() * apart_s;
        if nodes.last().is_none_or(|last| node > last + 0.5 * apart_s) {
            nodes.push(node);
        }
    }
    let signals: Vec<Vec<f64>> = (nodes.iter())
        .map(|node| {
            let hat = |time: f64| (1.0 - ((time - node) / apart_s).abs()).max(0.0);
            // less than there is, on either side
            (smooth.iter().zip(&states.time_s))
                .map(|(own, time)| -own.signum() * hat(*time))
                .collect()
        })
        .collect();
    let found = context.of_signals(EFFECT.name, joint, &signals, Rc::new(|_| Vec::new()))?;
    let mut found = found.in_spans();
    found.is_sound = |own| {
        let sum = |sign: f64| own.iter().map(|own| (sign * own).max(0.0)).sum::<f64>();
        sum(1.0) > RIGHT_SIDE * sum(-1.0)
    };
    found.shape = vec![("limit_nm", end)];
    // the median of those near the end
    found.shape_sd = Some(0.5 * sd);
    (found.kind, found.is_of_recording) = (CLIPPED, true);
    Some(found)
}

/// The value at which readings end, if they do: they pile up there, and above it are those alone that noise puts there. Those of a
/// crest, a parabola, are 2.7 times as dense in its top third as below.
fn end(all: &[f64], sd: f64) -> Option<f64> {
    let mut sizes: Vec<f64> = all.iter().map(|own| own.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let below = |value: f64| sizes.partition_point(|own| *own < value);
    let within = |from: f64, to: f64| below(to).saturating_sub(below(from)) as f64;
    let most = *sizes.last()?;
    let bins = (0..(most / sd).min(1e5) as usize).map(|bin| most - bin as f64 * sd);
    let dense = |value: &f64| within(value - sd, value + sd);
    // the densest of those above which there is nothing more
    let is_end = |value: &f64| {
        let at = within(value - END_SDS * sd, value + END_SDS * sd);
        all.len() as f64 - below(value + ABOVE_SDS * sd) as f64 <= MOST_ABOVE * at
    };
    let end = bins.take_while(|value| *value > 0.3 * most).filter(is_end);
    let end = end.max_by(|a, b| dense(a).total_cmp(&dense(b)))?;
    let at = within(end - END_SDS * sd, end + END_SDS * sd);
    let under = within(end - 3.0 * END_SDS * sd, end - END_SDS * sd);
    // both in bands of two standard deviations
    let per_width = under / END_SDS;
    let is_dense =
        at >= LEAST_FLAT * all.len() as f64 && dense(&end) > DENSER_AT_END * per_width.max(2.0);
    let from = below(end - 2.0 * sd);
    let nearby = &sizes[from..below(end + 2.0 * sd)];
    is_dense.then(|| nearby[nearby.len() / 2])
}

/// What the logged torque is beyond a limit on each side, the noise of its readings smoothed; all of it is lost, so its coefficients
/// are 1.
fn at(context: Context<'_>, joint: usize, limit: f64) -> Option<Candidate<'_>> {
    let logged = context.problem.recorded_torque(joint);
    let sides = [
        logged
            .iter()
            .map(|own| (own - limit).max(0.0))
            .collect::<Vec<f64>>(),
        logged.iter().map(|own| (own + limit).min(0.0)).collect(),
    ];
    let sides: Vec<Vec<f64>> = sides
        .into_iter()
        .filter(|side| side.iter().any(|own| *own != 0.0))
        .collect();
    let beyond =
        (logged.iter()).filter(|own| own.abs() > limit).count() as f64 / logged.len() as f64;
    if beyond > LONGEST_SATURATION {
        return None;
    }
    let mut found = context.of_signals(EFFECT.name, joint, &sides, Rc::new(|_| Vec::new()))?;
    // the noise of what is beyond the limit goes with it
    found.of_noise = 0.5 * beyond * context.problem.states.rows() as f64;
    found.is_sound = |own| {
        own.iter()
            .all(|own| *own == 0.0 || (own - 1.0).abs() < NEAR_ALL)
    };
    let again = Rc::new(move |limit| at(context, joint, limit));
    (!sides.is_empty()).then(|| found.shaped(("limit_nm", limit), 1.2, again))
}
