//! What would explain as much in the place of an effect that was taken.

use super::scored::{Pool, penalty};
use super::{Frame, State, columns_of, is_taken, nearest};

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
pub(super) fn rivals<'c>(
    frame: &Frame<'_>,
    pool: &Pool<'c>,
    whole: &State<'c>,
    index: usize,
    misfit: f64,
) -> (f64, Vec<Rival>) {
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
    (nats, found)
}
