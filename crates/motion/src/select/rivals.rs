//! What would explain as much in the place of an effect that was taken.

use std::rc::Rc;

use haptical_linalg::dot;

use super::scored::{Pool, penalty};
use super::{Frame, State, columns_of, is_taken, nearest};
use crate::effect::{Candidate, TORQUE_GAIN, is_of_own_joint};
use crate::thresholds::select::{LEAST_AT_JOINT, LEAST_LAST_NATS};

/// Another effect in the place of a pick.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rival {
    pub(crate) effect: &'static str,
    pub(crate) joint: Option<usize>,
    /// How far it is behind \[nats\], the misfit that is left allowed for.
    pub(crate) behind: f64,
    /// Share of the pick's own gain that it has.
    pub(crate) share: f64,
}

/// What is known of a pick beside the other picks.
pub(super) struct Beside {
    /// What it explains \[nats\].
    pub(super) nats: f64,
    pub(super) rivals: Vec<Rival>,
    /// Whether it does what its law does ([`is_told`]).
    pub(super) is_told: bool,
}

/// What a pick explains beside the other picks and the rivals in its place.
pub(super) fn rivals<'c>(
    frame: &Frame<'_>,
    pool: &Pool<'c>,
    whole: &State<'c>,
    index: usize,
    misfit: f64,
) -> Beside {
    let mut taken = whole.taken.clone();
    let own = taken.remove(index);
    // a delay that was taken is in the recorded rows: rivals in its place have to do without
    let early_s = whole.early_s.filter(|_| !own.is_delay_of_all());
    let others = State {
        fitted: frame.fitted(&columns_of(&taken, None), early_s),
        taken,
        early_s,
    };
    let nats = others.fitted.excess - whole.fitted.excess - penalty(frame, &own);
    let mut found = Vec::new();
    for other in nearest(frame, pool, &others) {
        let Some(candidate) = other
            .taken
            .last()
            .filter(|own| !is_taken(&whole.taken, own))
        else {
            continue;
        };
        let of_other = others.fitted.excess - other.fitted.excess - penalty(frame, candidate);
        found.push(Rival {
            effect: candidate.effect,
            joint: candidate.joint,
            behind: (nats - of_other) / misfit,
            share: of_other / nats.max(1e-9),
        });
    }
    found.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    Beside {
        nats,
        rivals: found,
        is_told: is_told(frame, &others, whole, &own),
    }
}

/// Whether a pick does what its law does. One that acts on the torque of its own joint alone has to explain most there: what is gained at
/// other joints is what the base model is freed for. A scale of a torque has to be told from an inertia ([`is_scale`]).
fn is_told(frame: &Frame<'_>, others: &State<'_>, whole: &State<'_>, own: &Candidate<'_>) -> bool {
    let Some(joint) = own.joint.filter(|_| is_of_own_joint(own.effect)) else {
        return true;
    };
    let Some(channel) = frame.problem.channel_of(joint) else {
        return true;
    };
    let rests = [&others.fitted, &whole.fitted].map(|own| own.solved.rest.as_slice());
    if gained_by_channel(frame.problem.states.rows(), rests, channel) < LEAST_AT_JOINT {
        return false;
    }
    own.effect != TORQUE_GAIN || is_scale(frame, others, whole, own, joint)
}

/// Share of what one rest's squares are less than another's that is of a channel; 1 where they are not less.
fn gained_by_channel(rows: usize, [without, with]: [&[f64]; 2], channel: usize) -> f64 {
    let gained = |range: std::ops::Range<usize>| {
        let [without, with] = [without, with].map(|own| &own[range.clone()]);
        dot(without, without) - dot(with, with)
    };
    let whole = gained(0..with.len());
    match whole > 0.0 {
        true => gained(channel * rows..(channel + 1) * rows) / whole,
        false => 1.0,
    }
}

/// Whether a scale of a torque explains more than a torque along the joint's own acceleration does, and something beside it: a scale shows in
/// weight and in what the other joints ask for as well, and one that does not is an inertia as well as it is a scale.
fn is_scale(
    frame: &Frame<'_>,
    others: &State<'_>,
    whole: &State<'_>,
    own: &Candidate<'_>,
    joint: usize,
) -> bool {
    let problem = frame.problem;
    let acceleration = &problem.states.motor.ddq[joint];
    let Some(inertia) = problem.of_joint(joint, acceleration) else {
        return true;
    };
    let excess = |columns: &[_]| frame.fitted(columns, others.early_s).excess;
    let mut columns = columns_of(&others.taken, None);
    columns.push(Rc::new(inertia));
    let of_inertia = excess(&columns);
    columns.extend(own.columns.iter().cloned());
    let of_both = excess(&columns);
    // the noise of a reading goes with it
    let of_scale = whole.fitted.excess + own.of_noise;
    of_inertia - of_both - own.of_noise > LEAST_LAST_NATS && of_inertia > of_scale
}
