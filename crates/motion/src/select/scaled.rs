//! One factor on all torques with another effect: alone each explains little more than bodies that are off do.

use std::convert::Infallible;

use haptical_judge::without_needless;

use super::scored::penalty;
use super::{Frame, Search, State, corrected, is_scale_of_all, with};
use crate::effect::{is_of_bodies, torque_gain};

/// The effects that are found next to one factor on all torques, where they explain more than several of which one is a body's.
pub(super) fn scaled<'c>(
    search: &mut Search<'_, '_, 'c>,
    start: &State<'c>,
    found: &State<'c>,
) -> Result<Option<State<'c>>, Infallible> {
    let has_body = found.taken.iter().any(|entry| is_of_bodies(entry.effect));
    if found.taken.len() < 2 || !has_body || found.taken.iter().any(is_scale_of_all) {
        return Ok(None);
    }
    let (frame, pool) = (search.frame, search.pool);
    let mut scales = pool.given_of(torque_gain::EFFECT.name);
    let scale = scales.find(|entry| is_scale_of_all(entry)).cloned();
    let Some(first) = scale.and_then(|scale| with(frame, start, scale)) else {
        return Ok(None);
    };
    let first = corrected(frame, start, first);
    let state = haptical_judge::select(search, first)?;
    let kept = without_needless(search, state, 1)?.state;
    let is_better =
        kept.taken.iter().any(is_scale_of_all) && cost(frame, &kept) < cost(frame, found);
    Ok(is_better.then_some(kept))
}

/// What a state leaves, its effects' numbers counted \[nats\].
pub(super) fn cost(frame: &Frame<'_>, state: &State<'_>) -> f64 {
    let numbers = state.taken.iter().map(|entry| penalty(frame, entry));
    state.fitted.excess + numbers.sum::<f64>()
}
