//! Rows by the hand that they are about: each hand has a chain of its own.

use std::ops::Range;

use haptical_model::{Device, Recording};

/// Hands with the rows that are about them, counted from the first of `rows`; none where a row does not say which.
pub(super) fn by_hand(
    device: &Device,
    recording: &Recording,
    rows: &Range<usize>,
) -> Option<Vec<(usize, Vec<usize>)>> {
    if !device.has_hands() {
        return Some(vec![(0, (0..rows.len()).collect())]);
    }
    let mut hands: Vec<(usize, Vec<usize>)> = Vec::new();
    for row in rows.clone() {
        let hand = device.hand_at(recording, row)?;
        let entry = row - rows.start;
        match hands.iter_mut().find(|(other, _)| *other == hand) {
            Some((_, own)) => own.push(entry),
            None => hands.push((hand, vec![entry])),
        }
    }
    Some(hands)
}
