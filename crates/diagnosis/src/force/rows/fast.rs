//! Changes within blocks: a motor's cogging at speed, which block means average away.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::FastRows;
use super::harmonics::ORDERS;
use crate::engine::system::dot;
use crate::force::along::Along;

/// The harmonics' deviations from block means against those of the torques less the base model's, over the noise
/// of a row, channel by channel.
pub(crate) fn rows(along: &Along<'_>, fitted: &[f64]) -> Vec<FastRows> {
    let recorded = along.recorded;
    let blocks = recorded.blocks.len();
    let channel_rows = |(channel, columns): (usize, &Vec<Vec<f64>>)| {
        let variance = recorded.row_sd(channel, &along.hand).powi(2).max(1e-300);
        let fitted = &fitted[channel * blocks..(channel + 1) * blocks];
        let rest = deviations(along, &recorded.torque_nm[channel], fitted);
        let rows: Vec<usize> = rest.iter().map(|(row, _)| *row).collect();
        let values: Vec<f64> = rest.iter().map(|(_, value)| *value).collect();
        let sizes = lengths(along, &rows);
        let own: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| {
                let mut part: Vec<f64> = rows.iter().map(|&row| column[row]).collect();
                centre(&mut part, &sizes);
                part
            })
            .collect();
        let (orders, controls) = own.split_at(2 * ORDERS);
        let variance = variance * colour(controls, &values, variance);
        let mut gram = DMatrix::from_fn(orders.len(), orders.len(), |a, b| match a >= b {
            true => dot(&orders[a], &orders[b]) / variance,
            false => 0.0,
        });
        gram.fill_upper_triangle_with_lower_triangle();
        let right = orders.iter().map(|column| dot(column, &values) / variance);
        FastRows::new(gram, &DVector::from_iterator(orders.len(), right))
    };
    recorded
        .harmonics
        .iter()
        .enumerate()
        .map(channel_rows)
        .collect()
}

/// What the noise's colour adds to scores: the median of those of the controls, orders between the
/// whole ones, over that of chi-square with two degrees of freedom.
fn colour(controls: &[Vec<f64>], values: &[f64], variance: f64) -> f64 {
    let mut scores: Vec<f64> = controls
        .chunks_exact(2)
        .filter_map(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let across = dot(a, b);
            let own = Matrix2::new(dot(a, a), across, across, dot(b, b));
            let along = Vector2::new(dot(a, values), dot(b, values));
            Some(along.dot(&(own.try_inverse()? * along)) / variance)
        })
        .filter(|score| score.is_finite())
        .collect();
    if scores.is_empty() {
        return 1.0;
    }
    scores.sort_by(f64::total_cmp);
    (scores[scores.len() / 2] / (2.0 * std::f64::consts::LN_2)).max(1.0)
}

/// What a channel's torque does within blocks beyond the base model: rows with their deviations
/// from the block's mean. Within a block the model is the quartic that has its means there and in
/// the two blocks on each side.
pub(crate) fn deviations(
    along: &Along<'_>,
    torque_nm: &[f64],
    fitted: &[f64],
) -> Vec<(usize, f64)> {
    let recorded = along.recorded;
    let count = recorded.blocks.len();
    let mut rest = Vec::new();
    for block in 2..count.saturating_sub(2) {
        let joined = (block - 1..=block + 2).all(|block| recorded.blocks[block].follows);
        let own = &recorded.blocks[block];
        if !joined || own.rows.len() < 2 {
            continue;
        }
        let means = [0, 1, 2, 3, 4].map(|k| fitted[block + k - 2]);
        let length = own.rows.len() as f64;
        let first = rest.len();
        for &row in &own.usable {
            let place = ((row - own.rows.start) as f64 + 0.5) / length - 0.5;
            let smooth = within(means, place);
            rest.push((row, torque_nm[row] - smooth));
        }
        let mean = rest[first..].iter().map(|(_, value)| value).sum::<f64>()
            / (rest.len() - first).max(1) as f64;
        rest[first..]
            .iter_mut()
            .for_each(|(_, value)| *value -= mean);
    }
    rest
}

/// The quartic with these means over five successive blocks, less its value in the middle, at a
/// place from -1/2 to 1/2 of the middle block.
pub(crate) fn within(means: [f64; 5], place: f64) -> f64 {
    let [a, b, c, d, e] = means;
    let slope = (5.0 * a - 34.0 * b + 34.0 * d - 5.0 * e) / 48.0;
    let curvature = (-a + 12.0 * b - 22.0 * c + 12.0 * d - e) / 8.0;
    let third = (e - 2.0 * d + 2.0 * b - a) / 2.0;
    let fourth = a - 4.0 * b + 6.0 * c - 4.0 * d + e;
    let higher = third / 6.0 + place * fourth / 24.0;
    place * (slope + place * (0.5 * curvature + place * higher))
}

/// Rows of each block among `rows`.
fn lengths(along: &Along<'_>, rows: &[usize]) -> Vec<usize> {
    let mut lengths = Vec::new();
    let mut at = 0;
    for block in &along.recorded.blocks {
        let start = at;
        while at < rows.len() && block.rows.contains(&rows[at]) {
            at += 1;
        }
        if at > start {
            lengths.push(at - start);
        }
    }
    lengths
}

fn centre(values: &mut [f64], lengths: &[usize]) {
    let mut first = 0;
    for &length in lengths {
        let part = &mut values[first..first + length];
        let mean = part.iter().sum::<f64>() / length as f64;
        part.iter_mut().for_each(|value| *value -= mean);
        first += length;
    }
}
