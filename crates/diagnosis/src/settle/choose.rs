//! The choice of pieces: greedy, then exchanges (Fedorov 1972), for the least odds of any candidate that may be true.

use rayon::prelude::*;

use super::gram::{Gram, Odds};

/// Nats that all pieces together must add before a recording can tell two candidates apart: ln 20.
const APART_NATS: f64 = 2.995_732_273_553_991;
/// Rounds in which chosen pieces are exchanged for others.
const EXCHANGE_ROUNDS: usize = 2;
/// What an exchange must gain \[nats\].
const LEAST_GAIN: f64 = 1e-6;

/// Pieces that tell candidates apart, and what to expect of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Settling {
    /// Positions of the chosen pieces, in the order in which they were chosen; a piece may come again.
    pub chosen: Vec<usize>,
    /// Odds once they are recorded, for every ordered pair of candidates.
    pub odds: Vec<Odds>,
    /// Pairs (true, other) that all pieces together, each recorded once, would not tell apart.
    pub inseparable: Vec<(usize, usize)>,
}

impl Settling {
    /// Least odds to expect of the pairs that can be told apart \[nats\], whichever of their candidates is true; none where
    /// no pair can.
    pub fn least_nats(&self) -> Option<f64> {
        Odds::least_nats(&self.odds, &self.inseparable)
    }
}

/// Chooses `count` of the pieces beside what is known; `odds_of` says what all rows together are expected to tell.
pub(super) fn choose(
    known: &Gram,
    pieces: &[Option<Gram>],
    count: usize,
    odds_of: &(dyn Fn(&Gram) -> Vec<Odds> + Sync),
) -> Settling {
    let mut whole = known.clone();
    pieces.iter().flatten().for_each(|piece| whole.add(piece));
    let all = odds_of(&whole);
    // a candidate that is far behind already need not be told from
    let is_lost = |odds: &&Odds| odds.gained_nats().max(odds.nats_after) < APART_NATS;
    let lost = all.iter().filter(is_lost);
    let inseparable: Vec<(usize, usize)> = lost.map(|odds| (odds.is_true, odds.other)).collect();
    let is_any_told = inseparable.len() < all.len();
    // the logarithm of the sum of the wrong odds: the worst pair decides, and the others have a say while it stands still
    let score = |gram: &Gram| {
        let odds = odds_of(gram);
        let told = odds
            .iter()
            .filter(|odds| !is_any_told || odds.is_told(&inseparable));
        let nats: Vec<f64> = told.map(|odds| odds.nats_after).collect();
        let least = nats.iter().copied().fold(f64::INFINITY, f64::min);
        least
            - nats
                .iter()
                .map(|nats| (least - nats).exp())
                .sum::<f64>()
                .ln()
    };
    let best = |without: &Gram| -> Option<(usize, f64)> {
        let scored: Vec<Option<f64>> = pieces
            .par_iter()
            .map(|piece| piece.as_ref().map(|piece| score(&without.plus(piece))))
            .collect();
        let there = scored.into_iter().enumerate();
        let there = there.filter_map(|(index, score)| Some((index, score?)));
        // the first of equals
        there.reduce(|best, other| if other.1 > best.1 { other } else { best })
    };
    let sum = |chosen: &[usize], but: Option<usize>| {
        let mut gram = known.clone();
        for (place, piece) in chosen.iter().enumerate() {
            if Some(place) != but
                && let Some(piece) = &pieces[*piece]
            {
                gram.add(piece);
            }
        }
        gram
    };
    let mut chosen: Vec<usize> = Vec::with_capacity(count);
    while chosen.len() < count
        && let Some((piece, _)) = best(&sum(&chosen, None))
    {
        chosen.push(piece);
    }
    for _ in 0..EXCHANGE_ROUNDS {
        let mut is_changed = false;
        for place in 0..chosen.len() {
            let before = score(&sum(&chosen, None));
            if let Some((piece, after)) = best(&sum(&chosen, Some(place)))
                && after > before + LEAST_GAIN
            {
                chosen[place] = piece;
                is_changed = true;
            }
        }
        if !is_changed {
            break;
        }
    }
    Settling {
        odds: odds_of(&sum(&chosen, None)),
        chosen,
        inseparable,
    }
}
