//! Forward selection.

use crate::question::{Forward, Ruling};

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
