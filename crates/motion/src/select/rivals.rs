//! What would explain as much in the place of an effect that was taken.

use std::rc::Rc;

use super::scored::{LEAST_LAST_NATS, Pool, penalty};
use super::{Frame, State, columns_of, is_taken, nearest};
use crate::effect::{Candidate, TORQUE_GAIN};

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
    /// Whether it explains something beside an inertia that the model lacks.
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

/// Whether a scale of a torque explains more than a torque along the joint's own acceleration does, and something beside it: a scale shows in
/// weight and in what the other joints ask for as well, and one that does not is an inertia as well as it is a scale.
fn is_told(frame: &Frame<'_>, others: &State<'_>, whole: &State<'_>, own: &Candidate<'_>) -> bool {
    let problem = frame.problem;
    let Some(joint) = own.joint.filter(|_| own.effect == TORQUE_GAIN) else {
        return true;
    };
    let acceleration = &problem.states.motor.ddq[joint];
    let Some(inertia) = problem.of_joint(joint, acceleration) else {
        return true;
    };
    let mut columns = columns_of(&others.taken, None);
    columns.push(Rc::new(inertia));
    let of_inertia = frame.fitted(&columns, others.early_s).excess;
    columns.extend(own.columns.iter().cloned());
    let of_both = frame.fitted(&columns, others.early_s).excess;
    of_inertia - of_both > LEAST_LAST_NATS && of_inertia > whole.fitted.excess
}
