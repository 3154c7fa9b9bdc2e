//! What would explain as much in the place of an effect that was taken.

use std::rc::Rc;

use haptical_judge::{Backward, InPlace, Other, Others, rivals};
use haptical_linalg::dot;

use super::scored::{Place, penalty};
use super::{Frame, Search, State, columns_of, is_scale_of_all, is_taken, nearest};
use crate::effect::{Candidate, is_of_own_joint, torque_gain};
use crate::thresholds::examine::LEFT_BY_LAW;
use crate::thresholds::select::{LEAST_AT_JOINT, LEAST_LAST_NATS, SAME_AS_SCALE};

/// Another effect in the place of a pick, and the share of the pick's gain that it has.
pub(crate) type Rival = haptical_judge::Rival<Place, f64>;

/// What is known of a pick with the others in the model.
pub(super) struct Compared {
    /// What it explains \[nats\].
    pub(super) nats: f64,
    pub(super) rivals: Vec<Rival>,
    /// Whether it does what its law does ([`is_told`]).
    pub(super) is_told: bool,
}

impl<'c> Search<'_, '_, 'c> {
    /// What a pick explains with the others in the model, and its rivals.
    pub(super) fn compared(&mut self, whole: &State<'c>, index: usize, misfit: f64) -> Compared {
        let Ok(without) = self.without(whole, index);
        let Ok(mut found) = rivals(self, whole, index, &without, misfit);
        for rival in &mut found {
            rival.fit /= without.worth.max(1e-9);
        }
        Compared {
            nats: without.worth,
            rivals: found,
            is_told: is_told(self.frame, &without.state, whole, &whole.taken[index]),
        }
    }
}

impl<'c> InPlace for Search<'_, '_, 'c> {
    type Name = Place;
    type Fit = f64;

    fn in_place(&mut self, without: &State<'c>, whole: &State<'c>, effect: usize) -> Others<Self> {
        let near = nearest(self.frame, self.pool, without);
        let pick = &whole.taken[effect];
        let of_pick = without.fitted.excess - whole.fitted.excess - penalty(self.frame, pick);
        let others = near.iter().filter_map(|other| {
            let last = other.taken.last()?;
            let merit = other.last_nats(self.frame, &without.fitted);
            // of the places of one law, rows alone tell, not how likely an inertia is to be off (docs/assumptions.md, A308)
            let by_rows = of_pick - other.fitted.behind(&whole.fitted);
            let merit = if is_scale_of_all(pick) || is_scale_of_all(last) {
                // bodies that are off may look like a factor to within a hundredth, and a factor like them
                let merit = merit.max(by_rows + pick.of_noise - last.of_noise);
                // and one that leaves less of the rows is as likely, whatever noise it may have followed
                match merit > SAME_AS_SCALE * of_pick || by_rows > of_pick {
                    true => merit.max(of_pick),
                    false => merit,
                }
            } else if last.effect == pick.effect {
                merit.max(by_rows)
            } else {
                merit
            };
            let other = Other {
                name: (last.effect, last.joint),
                merit,
                fit: merit,
            };
            let is_open = !is_scale_of_all(last) || whole.taken.len() == 1;
            (is_open && !is_taken(&whole.taken, last)).then_some(other)
        });
        Ok(others.collect())
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
    // what one effect alone explains all but for its law has bent the base model at the other joints
    let is_all = whole.taken.len() == 1 && whole.fitted.excess < LEFT_BY_LAW * others.fitted.excess;
    let at_joint = gained_by_channel(frame.problem.states.rows(), rests, channel);
    if !is_all && at_joint < LEAST_AT_JOINT {
        return false;
    }
    if let Some(plain) = &own.plain {
        let mut columns = columns_of(&others.taken);
        columns.push(Rc::clone(plain));
        let of_plain = frame.fitted(&columns, others.early_s).excess;
        if of_plain < whole.fitted.excess + LEAST_LAST_NATS {
            return false;
        }
    }
    own.effect != torque_gain::EFFECT.name || is_scale(frame, others, whole, own, joint)
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
    let mut columns = columns_of(&others.taken);
    columns.push(Rc::new(inertia));
    let of_inertia = excess(&columns);
    columns.extend(own.columns.iter().cloned());
    let of_both = excess(&columns);
    // the noise of a reading goes with it
    let of_scale = whole.fitted.excess + own.of_noise;
    of_inertia - of_both - own.of_noise > LEAST_LAST_NATS && of_inertia > of_scale
}
