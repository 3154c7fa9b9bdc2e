//! Whole recordings of the same length that are compared: what accumulates, such as creep, shows in no single piece.

use std::cmp::Ordering;

use haptical_design::Motion;
use haptical_diagnosis::{Odds, inseparable, score};

/// Recordings of pieces drawn at random among them.
const AT_RANDOM: usize = 4;

/// Lists of `count` of `drawn` pieces: at random first, then as they were chosen one by one, and for each candidate that leaves
/// something behind, by what it does: pieces that leave most one way, the other way, and first the one and then the other.
pub(super) fn wholes(
    chosen: Vec<usize>,
    lasting: &[Vec<f64>],
    drawn: usize,
    count: usize,
) -> Vec<Vec<usize>> {
    // the pieces are drawn at random: any of them are a random choice
    let random = |number: usize| -> Vec<usize> {
        let places = number * count..(number + 1) * count;
        places.map(|place| place % drawn.max(1)).collect()
    };
    let mut all: Vec<Vec<usize>> = (0..AT_RANDOM).map(random).collect();
    all.push(chosen);
    for lasting in lasting {
        let mut order: Vec<usize> = (0..drawn).collect();
        let falling = |a: &usize, b: &usize| lasting[*b].partial_cmp(&lasting[*a]);
        order.sort_by(|a, b| falling(a, b).unwrap_or(Ordering::Equal));
        let ends = order.first().zip(order.last());
        // what grows with time alone leaves as much behind along every piece
        let is_told = ends.is_some_and(|(most, least)| {
            let largest = lasting[*most].abs().max(lasting[*least].abs());
            lasting[*most] - lasting[*least] > 0.1 * largest
        });
        if !is_told {
            continue;
        }
        let most: Vec<usize> = order.iter().copied().take(count).collect();
        let least: Vec<usize> = order.iter().rev().copied().take(count).collect();
        let half = |first: &[usize], then: &[usize]| -> Vec<usize> {
            let (first, then) = (&first[..first.len() / 2], &then[..then.len().div_ceil(2)]);
            first.iter().chain(then).copied().collect()
        };
        all.push(half(&most, &least));
        all.push(half(&least, &most));
        all.push(most);
        all.push(least);
    }
    all
}

/// Nats of odds of 20 : 1.
const ENOUGH_NATS: f64 = 2.995_732_273_553_991;

/// A whole recording, and what it is expected to tell.
#[derive(Debug, Clone, Default)]
pub(super) struct Told {
    pub(super) pieces: Vec<usize>,
    pub(super) motion: Motion,
    pub(super) odds: Vec<Odds>,
}

/// What there is of one length.
pub(super) struct Found {
    pub(super) best: Told,
    pub(super) at_random: Told,
    /// Pairs of candidates that neither these recordings nor all pieces together tell apart.
    pub(super) inseparable: Vec<(usize, usize)>,
}

impl Found {
    /// The best of recordings, the first of which is at random; `of_all` are the odds of all pieces.
    pub(super) fn of(told: Vec<Told>, of_all: &[Odds]) -> Self {
        let mut all: Vec<&[Odds]> = told.iter().map(|own| own.odds.as_slice()).collect();
        all.push(of_all);
        let inseparable = inseparable(&all);
        let by_score = |a: &&Told, b: &&Told| {
            let of = |own: &Told| score(&own.odds, &inseparable);
            of(a).total_cmp(&of(b))
        };
        Self {
            best: told.iter().max_by(by_score).cloned().unwrap_or_default(),
            at_random: told.into_iter().next().unwrap_or_default(),
            inseparable,
        }
    }

    /// Whether a longer recording need not be looked for.
    pub(super) fn is_enough(&self) -> bool {
        let least = Odds::least_nats(&self.best.odds, &self.inseparable);
        self.inseparable.is_empty() && least.is_some_and(|nats| nats >= ENOUGH_NATS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_candidate_leaves_behind_orders_the_pieces() {
        // one creeps, the other one drifts with time
        let lasting = [vec![0.1, -2.0, 1.0, 0.5], vec![3.0, 3.0, 3.0, 3.0]];
        let all = wholes(vec![3, 3], &lasting, 4, 2);
        assert_eq!(all[0], [0, 1]);
        assert_eq!(all[AT_RANDOM], [3, 3]);
        assert_eq!(all[AT_RANDOM + 1..], [[2, 1], [1, 2], [2, 3], [1, 0]]);
    }
}
