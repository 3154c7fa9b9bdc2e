//! One path through pieces of motion.

use super::Motion;

/// Shortest way from one piece to the next \[s\].
const LEAST_WAY_S: f64 = 0.5;
/// Time for a way as long as a joint's whole range \[s\].
const RANGE_S: f64 = 2.0;

/// Joins pieces into one motion, each with a smooth way to the next; `ranges` are the joints' own, `rate_hz` the rows per second.
/// Of single postures the pieces follow each other.
///
/// The ways are the motion of least jerk (Flash & Hogan 1985): at rest at both ends.
pub fn path(pieces: &[&Motion], ranges: &[f64], rate_hz: Option<f64>) -> Motion {
    let mut whole = Motion::default();
    let Some(first) = pieces.first() else {
        return whole;
    };
    whole.joint = vec![Vec::new(); first.joint.len()];
    let has_force = pieces.iter().any(|piece| piece.force_n.is_some());
    let mut force: [Vec<f64>; 3] = Default::default();
    for (index, piece) in pieces.iter().enumerate() {
        let pressed = |row: usize| {
            let axes = piece.force_n.as_ref();
            axes.map_or([0.0; 3], |axes| [axes[0][row], axes[1][row], axes[2][row]])
        };
        let mut skipped = 0;
        if let (Some(rate_hz), true) = (rate_hz, index > 0 && !piece.is_empty()) {
            let rows = way(&mut whole.joint, piece, ranges, rate_hz);
            let before = force
                .each_ref()
                .map(|axis| axis.last().copied().unwrap_or(0.0));
            for row in 1..=rows {
                let share = smooth(row as f64 / rows as f64);
                for ((axis, from), to) in force.iter_mut().zip(before).zip(pressed(0)) {
                    axis.push(from + share * (to - from));
                }
            }
            // the way ends where the piece begins
            skipped = 1;
        }
        for (own, column) in whole.joint.iter_mut().zip(&piece.joint) {
            own.extend_from_slice(&column[skipped.min(column.len())..]);
        }
        for row in skipped..piece.len() {
            let now = pressed(row);
            for (axis, value) in force.iter_mut().zip(now) {
                axis.push(value);
            }
        }
    }
    let rows = whole.len();
    whole.time_s = rate_hz.map(|rate_hz| (0..rows).map(|row| row as f64 / rate_hz).collect());
    whole.force_n = has_force.then_some(force);
    whole.words = format!("{} pieces", pieces.len());
    whole
}

/// Rows from the end of what there is to the start of a piece.
fn way(joint: &mut [Vec<f64>], piece: &Motion, ranges: &[f64], rate_hz: f64) -> usize {
    let ends = joint.iter().zip(&piece.joint);
    let ends: Vec<[f64; 2]> = ends
        .map(|(own, next)| [own.last().copied().unwrap_or(next[0]), next[0]])
        .collect();
    let longest = ends.iter().zip(ranges);
    let longest = longest.map(|([from, to], range)| (to - from).abs() / range.max(1e-12));
    let way_s = (RANGE_S * longest.fold(0.0, f64::max)).max(LEAST_WAY_S);
    let rows = ((way_s * rate_hz).ceil() as usize).max(1);
    for (own, [from, to]) in joint.iter_mut().zip(ends) {
        own.extend((1..=rows).map(|row| from + smooth(row as f64 / rows as f64) * (to - from)));
    }
    rows
}

/// From 0 to 1 with the least jerk.
fn smooth(share: f64) -> f64 {
    share * share * share * (10.0 - share * (15.0 - 6.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(at: f64, newtons: f64) -> Motion {
        Motion {
            joint: vec![vec![at, at + 0.1, at], vec![0.0; 3]],
            time_s: Some(vec![0.0, 0.01, 0.02]),
            force_n: Some([vec![newtons; 3], vec![0.0; 3], vec![0.0; 3]]),
            words: String::new(),
        }
    }

    #[test]
    fn pieces_are_joined_without_a_jump() {
        let (first, second) = (piece(0.0, 0.0), piece(1.0, 2.0));
        let whole = path(&[&first, &second], &[2.0, 1.0], Some(100.0));
        // half of the range of 2 rad takes 1 s
        assert_eq!(whole.len(), 3 + 100 + 2);
        let steps = whole.joint[0]
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.11);
        assert_eq!(whole.joint[0][..3], first.joint[0]);
        assert_eq!(whole.joint[0][102..], second.joint[0]);
        let force = whole.force_n.unwrap();
        assert!((force[0][52] - 1.0).abs() < 0.05 && (force[0][102] - 2.0).abs() < 1e-12);
        let postures = path(&[&first, &second], &[2.0, 1.0], None);
        assert_eq!((postures.len(), postures.time_s), (6, None));
    }
}
