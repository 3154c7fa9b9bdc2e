//! Readings that stand alone, and recordings without them.

use haptical_calibration::Channel;
use haptical_effects::Context;
use haptical_model::Recording;

use crate::engine::base::problem::BaseProblem;
use crate::noise;
use crate::noise::outliers::NORMAL_MEDIAN;
use crate::noise::rounding;

/// Rows that stand alone in a channel (any of its axes), by the base model's residuals. `own` is each stream's stated
/// deviation without what the motor encoders' rounding adds.
pub(crate) fn outlying_rows(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    residual: &[Vec<f64>],
    own: &[f64],
    limit: f64,
) -> Vec<(Channel, usize)> {
    let mut found = Vec::new();
    for (index, stream) in context.streams.iter().enumerate() {
        let scaled: Vec<f64> = noise::without_lines(context, index, &residual[index])
            .iter()
            .zip(&problem.sd[index])
            .map(|(value, sd)| value / sd)
            .collect();
        let ratio = if context.ordered {
            noise::difference_sd(&scaled, &context.runs)
        } else {
            spread(&scaled)
        };
        let Some(ratio) = ratio.filter(|ratio| *ratio > 0.0) else {
            continue;
        };
        let sd = &problem.sd[index];
        let rounded = if context.ordered {
            rounded(sd, own[index], rounding::own_count(context, stream))
        } else {
            vec![0.0; sd.len()]
        };
        let limit = limit * ratio;
        let rows = noise::outliers(&scaled, &context.runs, context.ordered, limit, &rounded);
        found.extend(rows.into_iter().map(|row| (stream.channel, row)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// What rounding may put between a row and its neighbours, over each row's stated deviation `sd`: a count of the sensor,
/// and one of the motor encoders, whose rounding has the variance sd^2 - own^2 = (df/dtheta q)^2 / 12. At rest nothing
/// changes but counts, so differences of neighbours do not show this.
fn rounded(sd: &[f64], own: f64, count: f64) -> Vec<f64> {
    let rows = sd.iter();
    rows.map(|sd| (count + (12.0 * (sd * sd - own * own)).max(0.0).sqrt()) / sd)
        .collect()
}

/// Standard deviation from the median absolute value.
fn spread(scaled: &[f64]) -> Option<f64> {
    let sizes: Vec<f64> = scaled
        .iter()
        .filter(|value| value.is_finite())
        .map(|value| value.abs())
        .collect();
    let median = haptical_metrics::median(&sizes).ok()?;
    Some(median / NORMAL_MEDIAN)
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
