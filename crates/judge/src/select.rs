//! Forward selection, and taking out what later effects make needless.

use crate::question::{Forward, Needless, Ruling, Without};

/// Takes effects up one after the other, each the best given those before it, until no further one is admitted.
///
/// # Errors
/// Those of the models.
pub fn select<Q: Forward>(question: &mut Q, start: Q::State) -> Result<Q::State, Q::Error> {
    let mut state = start;
    loop {
        let proposals = question.proposals(&state)?.into_iter();
        // of equals the first
        let best = proposals.reduce(|best, other| match other.merit > best.merit {
            true => other,
            false => best,
        });
        let Some(best) = best else {
            return Ok(state);
        };
        match question.rule(&state, best)? {
            Ruling::Taken(next) => state = next,
            Ruling::Refused => {}
            Ruling::Ended => return Ok(state),
        }
    }
}

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
