//! Channels that were read and no longer are: a cable that was taken off, a tracker that lost its target.

use serde::Serialize;

use super::state::when;

/// A channel without readings, though the arm moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CeasedChannel {
    /// `out2`, `cable`, `position`.
    pub channel: String,
    /// Time of its last reading.
    pub last_read_s: f64,
}

impl CeasedChannel {
    /// A sentence.
    pub(super) fn line(&self) -> String {
        format!(
            "No reading of {} since {}, though the arm moved: from there on it is not judged.",
            self.channel,
            when(self.last_read_s)
        )
    }
}

/// Rows since each component was last read.
#[derive(Debug, Clone, Default)]
pub(super) struct Ceased {
    /// Rows without a reading, and the time of the last one; none before the first.
    since: Vec<Option<(u64, f64)>>,
}

impl Ceased {
    /// Takes a row at which the arm is elsewhere than at the last one; NaN is no reading.
    pub(super) fn take(&mut self, values: &[f64], time_s: f64) {
        self.since.resize(values.len(), None);
        for (since, value) in self.since.iter_mut().zip(values) {
            if value.is_finite() {
                *since = Some((0, time_s));
            } else if let Some((rows, _)) = since {
                *rows += 1;
            }
        }
    }

    /// The components that were not read for so many rows, and when they were last.
    pub(super) fn components(&self, rows: u64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.since.iter().enumerate();
        all.filter_map(move |(index, since)| {
            let (without, last_s) = (*since)?;
            (without >= rows).then_some((index, last_s))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_never_read_has_not_ceased_and_a_gap_is_no_end() {
        let mut own = Ceased::default();
        own.take(&[1.0, f64::NAN], 0.0);
        for row in 1..=5 {
            own.take(&[f64::NAN, f64::NAN], f64::from(row));
        }
        assert_eq!(own.components(5).collect::<Vec<_>>(), [(0, 0.0)]);
        assert_eq!(own.components(6).count(), 0);
        own.take(&[2.0, f64::NAN], 6.0);
        assert_eq!(own.components(1).count(), 0);
    }
}
