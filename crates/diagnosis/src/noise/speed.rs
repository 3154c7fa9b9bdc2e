//! Noise that grows with speed.

use std::ops::Range;

use super::colour::{leave_undisturbed, segment_basis, segment_moments};
use crate::thresholds::noise::{DEPENDS_ON_SPEED, SEGMENT_ROWS, SPEED_CLASSES, STANDS_STILL};

/// Scale of the noise at every row by the speed there, with mean square 1, and the ratio of the deviation
/// at the fastest quarter to that at the slowest; none where it does not depend on speed.
pub(crate) fn speed_scale(
    scaled: &[f64],
    speed: &[f64],
    runs: &[Range<usize>],
) -> Option<(Vec<f64>, f64)> {
    let basis = segment_basis();
    let mut segments: Vec<(f64, f64)> = Vec::new();
    for run in runs {
        let rows: Vec<usize> = run.clone().filter(|&row| scaled[row].is_finite()).collect();
        for part in rows.chunks_exact(SEGMENT_ROWS) {
            let values: Vec<f64> = part.iter().map(|&row| scaled[row]).collect();
            let fast = part.iter().map(|&row| speed[row].abs()).sum::<f64>() / SEGMENT_ROWS as f64;
            segments.push((fast, segment_moments(&values, &basis)[0]));
        }
    }
    if segments.len() < 16 * SPEED_CLASSES {
        return None;
    }
    segments.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = segments.len() / SPEED_CLASSES;
    let parts: Vec<(f64, f64)> = segments
        .chunks(size)
        .take(SPEED_CLASSES)
        .map(|part| {
            let mut squares: Vec<f64> = part.iter().map(|segment| segment.1).collect();
            leave_undisturbed(&mut squares, |square| *square);
            let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
            (
                part.iter().map(|segment| segment.0).sum::<f64>() / part.len() as f64,
                mean,
            )
        })
        .collect();
    let (slow, fast) = (parts[0].1, parts[SPEED_CLASSES - 1].1);
    if slow <= STANDS_STILL * fast || fast < DEPENDS_ON_SPEED * slow {
        return None;
    }
    let deviation = |speed: f64| {
        let next = parts
            .iter()
            .position(|part| part.0 > speed)
            .unwrap_or(SPEED_CLASSES);
        let square = match next {
            0 => parts[0].1,
            SPEED_CLASSES => parts[SPEED_CLASSES - 1].1,
            next => {
                let (before, after) = (parts[next - 1], parts[next]);
                let share = (speed - before.0) / (after.0 - before.0).max(1e-300);
                before.1 + share * (after.1 - before.1)
            }
        };
        square.sqrt()
    };
    let scale: Vec<f64> = speed.iter().map(|speed| deviation(speed.abs())).collect();
    let mean = scale.iter().map(|s| s * s).sum::<f64>() / scale.len().max(1) as f64;
    let norm = mean.sqrt().max(1e-300);
    Some((
        scale.into_iter().map(|s| s / norm).collect(),
        (fast / slow).sqrt(),
    ))
}
