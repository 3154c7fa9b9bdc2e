//! What would explain as much in the place of an effect that was taken.

use std::rc::Rc;

use super::scored::{LEAST_LAST_NATS, Pool, penalty, score};
use super::{Fitted, Frame, State, columns_of, is_taken, nearest};
use crate::effect::{Candidate, Finer, TORQUE_GAIN};

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

/// Steps of the logarithm of a shape's number within which what is explained has to fall for a standard deviation to be known.
const SHAPE_STEPS: [f64; 6] = [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];

/// What is known of a pick beside the other picks.
pub(super) struct Beside {
    /// What it explains \[nats\].
    pub(super) nats: f64,
    pub(super) rivals: Vec<Rival>,
    /// Standard deviation of the logarithm of its shape's number.
    pub(super) shape_sd: f64,
    /// Whether it explains something beside an inertia that the model lacks.
    pub(super) is_told: bool,
}

/// What a pick explains beside the other picks, how well its shape is known, and the rivals in its place.
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
        shape_sd: shape_sd(frame, &others.fitted, &own, misfit),
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

/// By how fast what is explained falls beside the shape that explains most: half a nat is one standard deviation (Wilks 1938).
fn shape_sd(frame: &Frame<'_>, others: &Fitted, own: &Candidate<'_>, misfit: f64) -> f64 {
    let Some(&(_, value)) = own.shape.first() else {
        return 0.0;
    };
    if let Some(sd) = own.shape_sd {
        return sd / value.abs().max(1e-300);
    }
    let Finer::Shape { at, .. } = &own.finer else {
        return 0.0;
    };
    let nats = |factor: f64| {
        let scored = at(value * factor).and_then(|own| score(frame, others, &own));
        scored.map_or(f64::NEG_INFINITY, |own| own.nats)
    };
    let here = nats(1.0);
    let mut drops = SHAPE_STEPS.iter().map(|step| {
        let beside = [nats(step.exp()), nats((-step).exp())];
        (step, here - beside[0].max(beside[1]))
    });
    let (step, drop) = drops
        .find(|(_, drop)| *drop > misfit)
        .unwrap_or((&1.0, misfit));
    step * (misfit / (2.0 * drop)).sqrt()
}
