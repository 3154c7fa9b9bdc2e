//! Poses of a tracker to the rows of the joint states, by their stamps.

/// A pose as a row has it: x, y, z \[m\], then the quaternion w, x, y, z.
pub(super) type PoseCells = [f64; 7];

/// Poses row by row.
pub(super) struct Matched {
    /// `NaN` in rows without a pose.
    pub(super) cells: Vec<PoseCells>,
    /// Poses that no row is near enough to.
    pub(super) left_out: usize,
    /// Largest distance in time between a row and its pose \[ns\].
    pub(super) farthest_ns: u64,
}

/// Gives each row the pose nearest in time, at most half the rows' usual distance away.
///
/// `stamps_ns` increases; poses come in any order. A pose is given to one row only: the one that it is
/// nearest to.
pub(super) fn match_poses(stamps_ns: &[i64], poses: &[(i64, PoseCells)]) -> Matched {
    let most_ns = usual_distance_ns(stamps_ns) / 2;
    let mut nearest: Vec<Option<(u64, PoseCells)>> = vec![None; stamps_ns.len()];
    let mut left_out = 0;
    for &(stamp_ns, cells) in poses {
        let after = stamps_ns.partition_point(|&row_ns| row_ns < stamp_ns);
        let candidates = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let row = candidates
            .filter_map(|row| Some((stamps_ns.get(row)?.abs_diff(stamp_ns), row)))
            .min();
        match row {
            Some((distance_ns, row)) if distance_ns <= most_ns => {
                let place = &mut nearest[row];
                left_out += usize::from(place.is_some());
                if place.is_none_or(|(other_ns, _)| distance_ns < other_ns) {
                    *place = Some((distance_ns, cells));
                }
            }
            _ => left_out += 1,
        }
    }
    let taken = || nearest.iter().flatten();
    Matched {
        left_out,
        farthest_ns: taken()
            .map(|&(distance_ns, _)| distance_ns)
            .max()
            .unwrap_or(0),
        cells: nearest
            .iter()
            .map(|place| place.map_or([f64::NAN; 7], |(_, cells)| cells))
            .collect(),
    }
}

/// The median distance between rows \[ns\].
fn usual_distance_ns(stamps_ns: &[i64]) -> u64 {
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

    fn pose(number: f64) -> PoseCells {
        [number; 7]
    }

    #[test]
    fn a_row_gets_the_nearest_pose_within_half_a_period() {
        let rows = [0, 10, 20, 30];
        // 4 is nearer to 0 than 5 would be; 11 beats 13 at row 10; 99 is nobody's
        let poses = [
            (4, pose(1.0)),
            (13, pose(2.0)),
            (11, pose(3.0)),
            (99, pose(4.0)),
        ];
        let matched = match_poses(&rows, &poses);
        let first: Vec<f64> = matched.cells.iter().map(|cells| cells[0]).collect();
        assert_eq!(first[..2], [1.0, 3.0]);
        assert!(first[2..].iter().all(|value| value.is_nan()));
        assert_eq!((matched.left_out, matched.farthest_ns), (2, 4));
    }

    #[test]
    fn equal_stamps_match_without_a_distance() {
        let rows = [i64::MIN, 0, i64::MAX];
        let poses = rows.map(|stamp| (stamp, pose(0.5)));
        let matched = match_poses(&rows, &poses);
        assert_eq!((matched.left_out, matched.farthest_ns), (0, 0));
        assert_eq!(matched.cells, [pose(0.5); 3]);
        assert_eq!(match_poses(&[], &poses).left_out, 3);
    }
}
