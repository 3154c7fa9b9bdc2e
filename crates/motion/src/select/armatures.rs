//! Armatures that are off at several joints at once: beside the others each explains little, and what the base model takes up of one it
//! gives back only when the others have their own.

use haptical_judge::without_needless;

use super::{Search, State, is_quiet, is_taken, with};
use crate::effect::armature;

/// The first state that leaves noise alone once the armatures that explain something are added: of those on the way of a selection,
/// then of each effect of the whole arm by itself. None where there is no such state.
pub(super) fn together<'c>(search: &mut Search<'_, '_, 'c>) -> Option<State<'c>> {
    let (frame, pool) = (search.frame, search.pool);
    let way = std::mem::take(&mut search.way);
    pool.given_of(armature::EFFECT.name).nth(1)?;
    let mut with_all = |state: &State<'c>| {
        let mut all = state.clone();
        for own in pool.given_of(armature::EFFECT.name) {
            if !is_taken(&all.taken, own) {
                all = with(frame, &all, own.clone())?;
            }
        }
        let Ok(kept) = without_needless(search, all, 1);
        is_quiet(frame.problem, &kept.state.fitted).then_some(kept.state)
    };
    let bare = way.first()?;
    let of_arm = pool.of_arm();
    let mut of_arm = of_arm.filter_map(|own| with(frame, bare, own.clone()));
    let on_the_way = way.iter().find_map(&mut with_all);
    on_the_way.or_else(|| of_arm.find_map(|own| with_all(&own)))
}
