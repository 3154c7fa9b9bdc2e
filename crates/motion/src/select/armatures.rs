//! Armatures that are off at several joints at once: beside the others each explains little, and what the base model takes up of one it
//! gives back only when the others have their own.

use super::scored::Pool;
use super::{Frame, State, is_quiet, is_taken, with, without_needless};
use crate::effect::ARMATURE;

/// The first state that leaves noise alone once the armatures that explain something are added: of those on the way of a selection,
/// then of each effect of the whole arm by itself. None where there is no such state.
pub(super) fn together<'c>(
    frame: &Frame<'_>,
    pool: &Pool<'c>,
    way: &[State<'c>],
) -> Option<State<'c>> {
    pool.given_of(ARMATURE).nth(1)?;
    let with_all = |state: &State<'c>| {
        let mut all = state.clone();
        for own in pool.given_of(ARMATURE) {
            if !is_taken(&all.taken, own) {
                all = with(frame, &all, own.clone())?;
            }
        }
        while let Some(fewer) = without_needless(frame, &all) {
            all = fewer;
        }
        is_quiet(frame.problem, &all.fitted).then_some(all)
    };
    let bare = way.first()?;
    let of_arm = pool.of_arm();
    let mut of_arm = of_arm.filter_map(|own| with(frame, bare, own.clone()));
    let on_the_way = way.iter().find_map(with_all);
    on_the_way.or_else(|| of_arm.find_map(|own| with_all(&own)))
}
