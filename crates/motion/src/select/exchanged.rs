//! Effects that were taken early, and that another one explains far better once the later ones are there.

use haptical_judge::{Backward as _, without_needless};

use super::scaled::cost;
use super::{Search, State, is_scale_of_all, is_taken, nearest};
use crate::thresholds::examine::NEAR_RIVAL_NATS;
use crate::thresholds::select::MOST_EXCHANGES;

/// The state with each effect exchanged for the one in its place that leaves surely less, until there is none.
pub(super) fn exchanged<'c>(search: &mut Search<'_, '_, 'c>, found: State<'c>) -> State<'c> {
    let mut state = found;
    for _ in 0..MOST_EXCHANGES {
        let Some(better) = better(search, &state) else {
            return state;
        };
        let Ok(further) = haptical_judge::select(search, better);
        let Ok(kept) = without_needless(search, further, 1);
        // with ever more effects everything is explained
        if kept.state.taken.len() > state.taken.len() {
            return state;
        }
        state = kept.state;
    }
    state
}

/// The best state with one other effect, where it leaves surely less.
fn better<'c>(search: &mut Search<'_, '_, 'c>, state: &State<'c>) -> Option<State<'c>> {
    if state.taken.len() < 2 {
        return None;
    }
    let frame = search.frame;
    let mut best: Option<(f64, State<'c>)> = None;
    for effect in 0..state.taken.len() {
        let Ok(without) = search.without(state, effect);
        for other in nearest(frame, search.pool, &without.state) {
            let is_other = (other.taken.last())
                .is_some_and(|last| !is_taken(&state.taken, last) && !is_scale_of_all(last));
            let cost = cost(frame, &other);
            if is_other && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, other));
            }
        }
    }
    let most = cost(frame, state) - NEAR_RIVAL_NATS;
    best.filter(|(cost, _)| *cost < most)
        .map(|(_, state)| state)
}
