//! Which parts of a long log are looked at.

use std::ops::Range;

use crate::thresholds::signal::{GOLDEN, MOST_JOINT_ROWS, STRETCH_ROWS};

/// Pieces, by their lengths in fine steps, with the steps of each that are looked at: all of them, or of a log with many more than
/// `MOST_JOINT_ROWS` rows stretches of long pieces, and some of the short ones as a whole. A row reaches `half` steps to either side, and rows
/// are `every` steps apart.
///
/// A stretch lies somewhere in its part of the piece, by the multiples of the golden ratio: evenly placed ones would meet a motion that repeats
/// itself at one of its places (Knuth, The Art of Computer Programming 3, 6.4).
pub(crate) fn stretches(
    lengths: &[usize],
    half: usize,
    every: usize,
) -> Vec<(usize, Range<usize>)> {
    let pieces = lengths.iter().copied().enumerate();
    let pieces = pieces.filter(|(_, length)| *length > 2 * half);
    let rows = |length: usize| (length - 2 * half).div_ceil(every);
    let all: usize = pieces.clone().map(|(_, length)| rows(length)).sum();
    if 4 * all <= 5 * MOST_JOINT_ROWS {
        return pieces.map(|(number, length)| (number, 0..length)).collect();
    }
    let share = MOST_JOINT_ROWS as f64 / all as f64;
    let mut found = Vec::new();
    // rows of short pieces that are still to be kept
    let mut due = 0.0;
    for (number, length) in pieces {
        let own = rows(length);
        if own <= 2 * STRETCH_ROWS {
            due += share * own as f64;
            if 2.0 * due >= own as f64 {
                due -= own as f64;
                found.push((number, 0..length));
            }
            continue;
        }
        let wanted = (share * own as f64).ceil() as usize;
        let count = wanted.div_ceil(STRETCH_ROWS);
        let steps = (wanted.div_ceil(count) - 1) * every + 1 + 2 * half;
        for part in 0..count {
            let [from, to] = [part, part + 1].map(|end| end * length / count);
            let spare = (to - from).saturating_sub(steps);
            let place = (GOLDEN * (found.len() + 1) as f64).fract();
            let first = from + (place * (spare + 1) as f64) as usize;
            found.push((number, first..(first + steps).min(to)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn a_long_log_is_looked_at_in_stretches_all_over_it() {
        let whole = [(0, 0..200), (2, 0..40)];
        assert_eq!(
            stretches(&[200, 8, 40], 4, 4),
            whole,
            "too short to have a row"
        );
        let (half, every) = (16, 4);
        let rows = |steps: &Range<usize>| (steps.len() - 2 * half).div_ceil(every);
        let mut lengths = vec![400_000, 33, 100_000, 33, 35];
        lengths.extend([272; 400]);
        let found = stretches(&lengths, half, every);
        let all: usize = found.iter().map(|(_, steps)| rows(steps)).sum();
        assert!(all.abs_diff(MOST_JOINT_ROWS) < 60, "{all}");
        let share = MOST_JOINT_ROWS as f64 / (100_000.0 + 25_000.0 + 400.0 * 60.0);
        let short = found.iter().filter(|own| own.0 >= 5);
        assert!((short.clone().count() as f64 - 400.0 * share).abs() < 2.0);
        for (number, steps) in short {
            assert_eq!(*steps, 0..lengths[*number], "as a whole");
        }
        for number in [0, 2] {
            let own: Vec<&Range<usize>> = (found.iter().filter(|own| own.0 == number))
                .map(|own| &own.1)
                .collect();
            let part = lengths[number] / own.len();
            for (k, steps) in own.iter().enumerate() {
                assert!(rows(steps) <= STRETCH_ROWS);
                assert!(k * part <= steps.start && steps.end <= (k + 1) * part + own.len());
            }
            assert!(own.windows(2).all(|pair| pair[0].end <= pair[1].start));
        }
    }

    /// A motion of as many cycles as there are stretches is met at all of its places.
    #[test]
    fn stretches_meet_all_of_a_motion_that_repeats_itself() {
        let found = stretches(&[100_000], 16, 4);
        let cycle = 100_000 / found.len();
        let mut is_met = [false; 20];
        for (_, steps) in &found {
            for step in steps.clone() {
                is_met[step % cycle * is_met.len() / cycle] = true;
            }
        }
        assert!(is_met.iter().all(|own| *own), "{is_met:?}");
    }

    /// Pieces of any lengths give stretches within them.
    #[test]
    fn stretches_lie_within_their_pieces() {
        let mut random = ChaCha8Rng::seed_from_u64(9);
        for _ in 0..300 {
            let (half, every) = (random.random_range(1..40), random.random_range(1..20));
            let pieces = random.random_range(1..60);
            let lengths: Vec<usize> = (0..pieces)
                .map(|_| {
                    let digits = random.random_range(2..9);
                    random.random_range(0..4_usize.pow(digits))
                })
                .collect();
            for (number, steps) in stretches(&lengths, half, every) {
                assert!(
                    steps.end <= lengths[number] && steps.len() > 2 * half,
                    "{steps:?}"
                );
            }
        }
    }
}
