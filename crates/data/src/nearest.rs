//! Rows of two recordings brought together by their stamps: each gets the nearest of the other.

/// The rows of another recording, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Nearest {
    /// For each row the index of the other's row that belongs to it; none where none is near.
    pub of_row: Vec<Option<usize>>,
    /// Rows of the other that belong to none.
    pub left_out: usize,
    /// Largest distance in time between a row and its other \[ns\].
    pub farthest_ns: u64,
}

/// Gives each row the other recording's row that is nearest in time, at most `most_ns` away.
///
/// `stamps_ns` increases; the others come in any order. An other is given to one row only: the one that it is nearest to.
///
/// ```
/// use haptical_data::nearest;
///
/// // 13 is nearer to 10 than to 20; 11 is nearer still
/// let found = nearest(&[0, 10, 20], &[1, 13, 11], 5);
/// assert_eq!(found.of_row, [Some(0), Some(2), None]);
/// assert_eq!((found.left_out, found.farthest_ns), (1, 1));
/// ```
pub fn nearest(stamps_ns: &[i64], others_ns: &[i64], most_ns: u64) -> Nearest {
    let mut best: Vec<Option<(u64, usize)>> = vec![None; stamps_ns.len()];
    let mut left_out = 0;
    for (other, &stamp_ns) in others_ns.iter().enumerate() {
        let after = stamps_ns.partition_point(|&row_ns| row_ns < stamp_ns);
        let candidates = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let row = candidates
            .filter_map(|row| Some((stamps_ns.get(row)?.abs_diff(stamp_ns), row)))
            .min();
        match row {
            Some((distance_ns, row)) if distance_ns <= most_ns => {
                let place = &mut best[row];
                left_out += usize::from(place.is_some());
                if place.is_none_or(|(there_ns, _)| distance_ns < there_ns) {
                    *place = Some((distance_ns, other));
                }
            }
            _ => left_out += 1,
        }
    }
    let taken = best.iter().flatten();
    Nearest {
        left_out,
        farthest_ns: taken
            .map(|&(distance_ns, _)| distance_ns)
            .max()
            .unwrap_or(0),
        of_row: best
            .iter()
            .map(|place| place.map(|(_, other)| other))
            .collect(),
    }
}

/// The median distance between rows \[ns\].
pub fn usual_distance_ns(stamps_ns: &[i64]) -> u64 {
    let mut distances: Vec<u64> = stamps_ns
        .windows(2)
        .map(|pair| pair[1].abs_diff(pair[0]))
        .collect();
    distances.sort_unstable();
    distances.get(distances.len() / 2).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_gets_the_nearest_other_within_half_a_period() {
        let rows = [0, 10, 20, 30];
        assert_eq!(usual_distance_ns(&rows), 10);
        // 4 is nearer to 0 than 5 would be; 11 beats 13 at row 10; 99 is nobody's
        let found = nearest(&rows, &[4, 13, 11, 99], 5);
        assert_eq!(found.of_row, [Some(0), Some(2), None, None]);
        assert_eq!((found.left_out, found.farthest_ns), (2, 4));
    }

    #[test]
    fn equal_stamps_match_without_a_distance() {
        let rows = [i64::MIN, 0, i64::MAX];
        let found = nearest(&rows, &rows, u64::MAX);
        assert_eq!(found.of_row, [Some(0), Some(1), Some(2)]);
        assert_eq!((found.left_out, found.farthest_ns), (0, 0));
        assert_eq!(nearest(&[], &rows, u64::MAX).left_out, 3);
    }
}
