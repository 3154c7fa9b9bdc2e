//! The choice of pieces: greedy, then exchanges (Fedorov 1972), for the least odds of any candidate that may be true.

use haptical_judge::NAMED_PROBABILITY;

use super::gram::{Gram, Odds};
use crate::thresholds::settle::{EXCHANGE_ROUNDS, LEAST_EXCHANGE_NATS};

/// Log-odds from which the first name is given without hedging \[nats\].
fn named_nats() -> f64 {
    (NAMED_PROBABILITY / (1.0 - NAMED_PROBABILITY)).ln()
}

/// Pairs (true, other) of which none of these recordings lets the true one be named.
pub fn inseparable(recordings: &[&[Odds]]) -> Vec<(usize, usize)> {
    let Some((first, _)) = recordings.split_first() else {
        return Vec::new();
    };
    let is_named = |pair: usize| {
        let mut all = recordings.iter();
        all.any(|odds| odds[pair].nats_after >= named_nats())
    };
    let lost = first
        .iter()
        .enumerate()
        .filter(|(pair, _)| !is_named(*pair));
    lost.map(|(_, odds)| (odds.is_true, odds.other)).collect()
}

/// The logarithm of the sum of the wrong odds, its sign changed: the worst pair decides, and the others have a say while it
/// stands still. Pairs that nothing tells apart are left out, unless there are no others.
pub fn score(odds: &[Odds], inseparable: &[(usize, usize)]) -> f64 {
    let is_any_told = inseparable.len() < odds.len();
    let told = odds
        .iter()
        .filter(|odds| !is_any_told || odds.is_told(inseparable));
    let nats: Vec<f64> = told.map(|odds| odds.nats_after).collect();
    let least = nats.iter().copied().fold(f64::INFINITY, f64::min);
    let wrong: f64 = nats.iter().map(|nats| (least - nats).exp()).sum();
    least - wrong.ln()
}

/// Chooses `count` of the pieces beside what is known; `odds_of` says what all rows together are expected to tell, the laws'
/// look-alikes left out of it: how far they go together shows over a whole recording alone.
pub(super) fn choose(
    known: &Gram,
    pieces: &[Option<Gram>],
    count: usize,
    odds_of: &(dyn Fn(&Gram) -> Vec<Odds> + Sync),
) -> Vec<usize> {
    let mut whole = known.clone();
    pieces.iter().flatten().for_each(|piece| whole.add(piece));
    let lost = inseparable(&[&odds_of(&whole)]);
    let score = |gram: &Gram| score(&odds_of(gram), &lost);
    let best = |without: &Gram| -> Option<(usize, f64)> {
        let scored = haptical_parallel::map(pieces, |piece| {
            piece.as_ref().map(|piece| score(&without.plus(piece)))
        });
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
                && after > before + LEAST_EXCHANGE_NATS
            {
                chosen[place] = piece;
                is_changed = true;
            }
        }
        if !is_changed {
            break;
        }
    }
    chosen
}
