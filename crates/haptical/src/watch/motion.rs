//! Rows that are readings of their own: those at which the arm is elsewhere than at the last one.

use haptical_model::Recording;

/// Least motion of a joint \[rad\] or \[m\] that makes a row a reading of its own: what the model gets wrong
/// stays the same while the arm rests, and a rest of an hour says as much of it as one row.
const MOTION: f64 = 2e-4;

/// Whether a joint moved since the row that was the last reading of its own; then this row is the last one.
pub(super) fn moved_since(last: &mut Vec<f64>, recording: &Recording, row: usize) -> bool {
    let now = || recording.joint.iter().filter_map(|column| column.get(row));
    let has_moved = last.len() != recording.joint.len()
        || now()
            .zip(last.iter())
            .any(|(now, last)| (now - last).abs() > MOTION);
    if has_moved {
        last.clear();
        last.extend(now());
    }
    has_moved
}
