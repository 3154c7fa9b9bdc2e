//! Rows that are readings of their own: those at which the arm is elsewhere than at the last one.

use haptical_calibration::Channel;
use haptical_model::Recording;

use super::Component;

/// Least motion of a joint \[rad\] or \[m\] that makes a row a reading of its own: what the model gets wrong
/// stays the same while the arm rests, and a rest of an hour says as much of it as one row.
const MOTION: f64 = 2e-4;
/// Counts that a joint moves until its external encoder is read anew. What rounding gets wrong repeats with each count; steps by the
/// golden ratio meet all parts of a count evenly, however slowly the joint moves (docs/assumptions.md, A250).
const COUNTS: f64 = 1.618_033_988_749_895;
/// A count of an encoder over its noise (docs/assumptions.md, A25).
const NOISE_PER_COUNT: f64 = 3.0;

/// The joint that a channel sees alone, and how far it moves between two readings of their own; none of other channels.
pub(super) fn joint_of(channel: &Channel, noise: f64) -> Option<(usize, f64)> {
    match channel {
        Channel::Output { joint } => Some((*joint, MOTION.max(COUNTS * NOISE_PER_COUNT * noise))),
        _ => None,
    }
}

/// Where the joints were at the last readings of their own.
#[derive(Debug, Clone, Default)]
pub(super) struct Motion {
    /// Of the row.
    last: Vec<f64>,
    /// Of each component that sees one joint.
    own: Vec<f64>,
}

impl Motion {
    /// Whether a joint moved since the row that was the last reading of its own; then this row is the last one.
    pub(super) fn has_moved(&mut self, recording: &Recording, row: usize) -> bool {
        let now = || recording.joint.iter().filter_map(|column| column.get(row));
        let mut pairs = now().zip(&self.last);
        let has_moved = self.last.len() != recording.joint.len()
            || pairs.any(|(now, last)| (now - last).abs() > MOTION);
        if has_moved {
            self.last.clear();
            self.last.extend(now());
        }
        has_moved
    }

    /// Empties the values of components whose joint has not moved since they were last read.
    pub(super) fn thin(&mut self, components: &[Component], joints: &[f64], values: &mut [f64]) {
        self.own.resize(components.len(), f64::NAN);
        for ((last, component), value) in self.own.iter_mut().zip(components).zip(values) {
            let Some((joint, step)) = component.joint else {
                continue;
            };
            let now = joints.get(joint).copied().unwrap_or(f64::NAN);
            match last.is_nan() || (now - *last).abs() > step {
                true if value.is_finite() => *last = now,
                true => {}
                false => *value = f64::NAN,
            }
        }
    }
}
