//! Rows of a fast log put together: the regression's memory is a number of rows, and must hold the delays that a servo has.

use std::ops::Range;

use crate::log::{Series, mean};
use crate::thresholds::DELAY_STEP_S;

/// A log of means over so many rows each, and the rows of each mean.
///
/// A loop that is linear answers the mean of its commands with the mean of its positions.
#[derive(Debug)]
pub(super) struct Thinned {
    pub(super) series: Series,
    rows: Vec<Range<usize>>,
    by: usize,
}

impl Thinned {
    /// As slow as a change of a delay is looked for; none where the log is no faster.
    pub(super) fn new(series: &Series) -> Option<Self> {
        let by = (DELAY_STEP_S / series.step_s).round() as usize;
        (by > 1).then(|| Self::by(series, by))
    }

    fn by(series: &Series, by: usize) -> Self {
        let mut rows: Vec<Range<usize>> = Vec::new();
        let mut starts = Vec::new();
        for piece in series.pieces().filter(|piece| piece.len() >= by) {
            starts.push(rows.len());
            let firsts = piece.clone().step_by(by);
            rows.extend(
                firsts
                    .map(|first| first..first + by)
                    .filter(|own| own.end <= piece.end),
            );
        }
        let means = |column: &[f64]| -> Vec<f64> {
            rows.iter().map(|own| mean(&column[own.clone()])).collect()
        };
        let thin = Series {
            row: rows.iter().map(|own| series.row[own.start]).collect(),
            run: rows.iter().map(|own| series.run[own.start]).collect(),
            time_s: means(&series.time_s),
            command: means(&series.command),
            response: means(&series.response),
            velocity: series.velocity.as_deref().map(means),
            torque: None,
            others: Vec::new(),
            load_nm: None,
            scored: std::iter::once(0..rows.len()).collect(),
            starts,
            step_s: by as f64 * series.step_s,
            count: series.count,
            warnings: Vec::new(),
        };
        Self {
            series: thin,
            rows,
            by,
        }
    }

    /// Rows of the log in the place of rows of the means: the first, the likeliest and the last of a change.
    pub(super) fn rows(&self, [first, at, last]: [usize; 3]) -> [usize; 3] {
        let own = |row: usize| &self.rows[row.min(self.rows.len() - 1)];
        [
            own(first.saturating_sub(1)).start + 1,
            own(at).start,
            own(last).end - 1,
        ]
    }

    /// So many rows of the means in rows of the log.
    pub(super) fn whole(&self, rows: f64) -> f64 {
        rows * self.by as f64
    }
}
