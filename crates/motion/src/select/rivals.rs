//! What would explain as much in the place of an effect that was taken.

use super::scored::{Pool, Scored, penalty};
use super::{DELAY, Fitted, columns_of, is_taken, refine};

/// Rivals that are told, nearest first.
const MOST: usize = 8;
/// Share of a pick's gain from which on a rival's shape is settled too.
const NEAR: f64 = 0.6;

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

/// What a pick explains beside the other picks, and the rivals in its place.
pub(super) fn rivals(
    whole: &Fitted<'_>,
    pool: &Pool<'_>,
    picks: &[Scored<'_>],
    index: usize,
    early_s: Option<f64>,
    misfit: f64,
) -> (f64, Vec<Rival>) {
    // a delay that was taken is in the recorded rows: rivals in its place have to do without
    let is_delay = picks[index].candidate.effect == DELAY;
    let early_s = early_s.filter(|_| !is_delay);
    let columns = columns_of(picks, Some(index));
    let others = Fitted::new(whole.problem, whole.base, &columns, early_s);
    let full = others.excess() - whole.excess();
    // by the whole fit, where numbers at their limits may have come back
    let own = full - penalty(&picks[index].candidate, &others);
    let mut found: Vec<Rival> = Vec::new();
    for scored in pool.scored(&others) {
        if is_taken(picks, &scored.candidate) {
            continue;
        }
        let scored = match scored.nats > NEAR * own {
            true => refine::refined(&others, scored),
            false => scored,
        };
        let rival = Rival {
            effect: scored.candidate.effect,
            joint: scored.candidate.joint,
            behind: (own - scored.nats) / misfit,
            share: scored.nats / own.max(1e-9),
        };
        let mut same = found.iter_mut();
        match same.find(|own| own.effect == rival.effect && own.joint == rival.joint) {
            Some(same) if rival.behind < same.behind => *same = rival,
            Some(_) => {}
            None => found.push(rival),
        }
    }
    found.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    found.truncate(MOST);
    (own, found)
}
