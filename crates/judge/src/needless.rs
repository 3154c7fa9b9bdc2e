//! Effects that others, which were taken up later, make needless.

use crate::question::{Needless, Without};

/// A model whose effects are all needed.
#[derive(Debug, Clone)]
pub struct Kept<S> {
    /// The model.
    pub state: S,
    /// What each effect explains with the others in the model; none where the model had no more than the fewest effects.
    pub worth: Option<Vec<f64>>,
}

/// Takes needless effects out one by one, that of the least worth first, while more than `fewest` are left.
///
/// # Errors
/// Those of the models.
pub fn without_needless<Q: Needless>(
    question: &mut Q,
    start: Q::State,
    fewest: usize,
) -> Result<Kept<Q::State>, Q::Error> {
    let mut kept = Kept {
        state: start,
        worth: None,
    };
    while question.effects(&kept.state) > fewest {
        let effects = 0..question.effects(&kept.state);
        let all: Vec<Without<Q::State>> = effects
            .map(|effect| question.without(&kept.state, effect))
            .collect::<Result<_, _>>()?;
        let mut least: Option<usize> = None;
        for (effect, without) in all.iter().enumerate() {
            let is_less = least.is_none_or(|least| without.worth < all[least].worth);
            if is_less && question.is_needless(&kept.state, effect, &all)? {
                least = Some(effect);
            }
        }
        let mut worth: Vec<f64> = all.iter().map(|without| without.worth).collect();
        let Some(least) = least else {
            kept.worth = Some(worth);
            break;
        };
        worth.remove(least);
        let Some(next) = all.into_iter().nth(least) else {
            break;
        };
        kept = Kept {
            state: question.refitted(next.state)?,
            worth: Some(worth),
        };
    }
    Ok(kept)
}
