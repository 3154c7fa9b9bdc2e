//! Changes within blocks: a motor's cogging at speed, which block means average away.

use nalgebra::{DVector, Matrix2, Vector2};

use super::Means;
use super::along::Along;
use super::harmonics::{ORDERS, matrix};
use super::recorded::{Block, Recorded};
use super::rows::FastRows;

/// Rows of the harmonics within blocks, channel by channel, over the noise of a row. Deviations of the harmonics from
/// block means are to explain those of the torques less the base model's.
pub(super) fn rows(along: &Along<'_>, fitted: &Means) -> Vec<FastRows> {
    let recorded = &along.recorded;
    let of_channel = |(channel, columns): (usize, &Vec<Vec<f64>>)| {
        let variance = along.row_sd(channel).powi(2).max(1e-300);
        let fitted: Vec<f64> = fitted.column(channel).iter().copied().collect();
        let rest = deviations(recorded, &recorded.torque_nm[channel], &fitted);
        let values: Vec<f64> = rest
            .iter()
            .flat_map(|(_, values)| values.iter().copied())
            .collect();
        let values = DVector::from_vec(values);
        let harmonics = columns.iter().map(|column| -> Vec<f64> {
            let of_block = |(block, _): &(&Block, _)| about_mean(block, |row| column[row]);
            rest.iter().flat_map(of_block).collect()
        });
        let all = matrix(harmonics, values.len());
        let (orders, controls) = all.columns_range_pair(..2 * ORDERS, 2 * ORDERS..);
        let scores = (0..ORDERS).filter_map(|order| {
            let [a, b] = [2 * order, 2 * order + 1].map(|k| controls.column(k));
            let across = a.dot(&b);
            let gram = Matrix2::new(a.norm_squared(), across, across, b.norm_squared());
            let right = Vector2::new(a.dot(&values), b.dot(&values));
            Some(right.dot(&(gram.try_inverse()? * right)) / variance)
        });
        let variance = variance * colour(scores.collect());
        let right = orders.tr_mul(&values) / variance;
        FastRows::new(orders.tr_mul(&orders) / variance, &right)
    };
    let channels = recorded.harmonics.iter().enumerate();
    channels.map(of_channel).collect()
}

/// Factor by which the noise's colour raises scores: the controls' median over that of chi-square with two degrees of
/// freedom. The controls are orders between the whole ones.
fn colour(mut scores: Vec<f64>) -> f64 {
    scores.retain(|score| score.is_finite());
    scores.sort_by(f64::total_cmp);
    let median = scores.get(scores.len() / 2).copied();
    median.map_or(1.0, |median| {
        (median / (2.0 * std::f64::consts::LN_2)).max(1.0)
    })
}

/// What a channel's torque does within blocks beyond the base model: deviations of the usable rows from their block's
/// mean. Within a block, the model is the quartic that has its means there and in the two blocks on each side.
pub(super) fn deviations<'r>(
    recorded: &'r Recorded<'_>,
    torque_nm: &[f64],
    fitted: &[f64],
) -> Vec<(&'r Block, Vec<f64>)> {
    let blocks = &recorded.blocks;
    let is_joined = |first: usize| {
        blocks[first + 1..first + 5]
            .iter()
            .all(|block| block.follows)
    };
    let of_block = |(first, fitted): (usize, &[f64])| {
        let block = &blocks[first + 2];
        let means: &[f64; 5] = fitted.first_chunk()?;
        let length = block.rows.len() as f64;
        let rest = |row: usize| {
            let place = ((row - block.rows.start) as f64 + 0.5) / length - 0.5;
            torque_nm[row] - within(*means, place)
        };
        let is_known = is_joined(first) && block.rows.len() > 1;
        is_known.then(|| (block, about_mean(block, rest)))
    };
    fitted.windows(5).enumerate().filter_map(of_block).collect()
}

/// Values of a block's usable rows about their mean.
fn about_mean(block: &Block, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = block.usable.iter().map(|&row| value(row)).collect();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values
}

/// The quartic with these means over five successive blocks, less its value in the middle. `place` is from -1/2 to
/// 1/2 of the middle block.
pub(super) fn within(means: [f64; 5], place: f64) -> f64 {
    let [a, b, c, d, e] = means;
    let slope = (5.0 * a - 34.0 * b + 34.0 * d - 5.0 * e) / 48.0;
    let curvature = (-a + 12.0 * b - 22.0 * c + 12.0 * d - e) / 8.0;
    let third = (e - 2.0 * d + 2.0 * b - a) / 2.0;
    let fourth = a - 4.0 * b + 6.0 * c - 4.0 * d + e;
    let higher = third / 6.0 + place * fourth / 24.0;
    place * (slope + place * (0.5 * curvature + place * higher))
}
