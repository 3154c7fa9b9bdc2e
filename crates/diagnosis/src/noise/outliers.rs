//! Rows that stand alone, a size of the noise that they cannot move, and recordings without them.

use std::ops::Range;

use haptical_calibration::Channel;
use haptical_model::Recording;

/// Median of the magnitude of a normal deviate.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Rows whose value stands alone: further than `limit` and what rounding adds, `rounded` of each row, from the median of
/// so many rows on either side, which follow a motion, a jump or a drift; from zero where there is no order.
pub(crate) fn outliers(
    scaled: &[f64],
    runs: &[Range<usize>],
    reach: Option<usize>,
    limit: f64,
    rounded: &[f64],
) -> Vec<usize> {
    let mut found = Vec::new();
    for run in runs {
        let rows: Vec<usize> = run.clone().filter(|&row| scaled[row].is_finite()).collect();
        for (index, &row) in rows.iter().enumerate() {
            let centre = if let Some(reach) = reach {
                let first = index.saturating_sub(reach);
                let end = (index + reach + 1).min(rows.len());
                let mut around: Vec<f64> = rows[first..end].iter().map(|&r| scaled[r]).collect();
                around.sort_by(f64::total_cmp);
                around[around.len() / 2]
            } else {
                0.0
            };
            if (scaled[row] - centre).abs() > limit + rounded[row] {
                found.push(row);
            }
        }
    }
    found
}

/// Median of the absolute differences of neighbours, as a standard deviation: a size of the noise
/// that outliers and gaps cannot move.
pub(crate) fn difference_sd(scaled: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let mut steps: Vec<f64> = Vec::new();
    for run in runs {
        let values: Vec<f64> = scaled[run.clone()]
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        // second differences: a slope is not noise
        steps.extend(
            values
                .windows(3)
                .map(|w| (w[0] - 2.0 * w[1] + w[2]).abs() / 6.0_f64.sqrt()),
        );
    }
    let median = haptical_metrics::median(&steps).ok()?;
    Some(median / NORMAL_MEDIAN)
}

/// Standard deviation from the median absolute value.
pub(crate) fn spread(scaled: &[f64]) -> Option<f64> {
    let finite = scaled.iter().filter(|value| value.is_finite());
    let sizes: Vec<f64> = finite.map(|value| value.abs()).collect();
    Some(haptical_metrics::median(&sizes).ok()? / NORMAL_MEDIAN)
}

/// A copy of a recording without some readings.
pub(crate) fn without_readings(recording: &Recording, gone: &[(Channel, usize)]) -> Recording {
    let mut cleaned = recording.clone();
    for &(channel, row) in gone {
        match channel {
            Channel::Output { joint } => {
                if let Some(Some(column)) = cleaned.output.get_mut(joint) {
                    column[row] = f64::NAN;
                }
            }
            Channel::Cable { index } => {
                if let Some(Some(column)) = cleaned.cable_m.get_mut(index) {
                    column[row] = f64::NAN;
                }
            }
            Channel::Position => {
                for column in cleaned.position_m.iter_mut().flatten() {
                    column[row] = f64::NAN;
                }
            }
            Channel::Orientation => {
                for column in cleaned.orientation_wxyz.iter_mut().flatten() {
                    column[row] = f64::NAN;
                }
            }
            Channel::Contact => {
                if let Some(ids) = &mut cleaned.contact {
                    ids[row].clear();
                }
            }
            Channel::Plane => {
                if let Some(ids) = &mut cleaned.plane {
                    ids[row].clear();
                }
            }
            // one reading of a whole recording, or one in front of any motion: nothing to clean
            Channel::ContactPair { .. } | Channel::PlanePair { .. } | Channel::Fixture { .. } => {}
        }
    }
    cleaned
}
