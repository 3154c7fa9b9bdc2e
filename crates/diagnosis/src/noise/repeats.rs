//! The noise that repeats of a posture show: what they scatter by is no gap, whatever the model.

use std::collections::BTreeMap;

use haptical_effects::Context;

use super::{Noise, NoiseSource};
use crate::thresholds::noise::{ENOUGH_REPEATS, SAME_POSTURE};

/// Rows of each posture that was recorded more than once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Repeats {
    groups: Vec<Vec<usize>>,
    /// Each group was approached from one side: a play does not scatter it.
    pub(crate) are_of_one_side: bool,
}

impl Repeats {
    /// Repeats within a run and from one side where there are enough of them, else from any run, else from any side. None
    /// in a motion, whose rows are compared with their neighbours.
    pub(crate) fn new(context: &Context<'_>) -> Self {
        if context.ordered {
            return Self::default();
        }
        let posture = postures(context);
        let (run, side) = approaches(context, &posture);
        let by = |key: &dyn Fn(usize) -> (usize, usize, Vec<i8>)| {
            let mut groups: BTreeMap<_, Vec<usize>> = BTreeMap::new();
            for row in 0..posture.len() {
                groups.entry(key(row)).or_default().push(row);
            }
            let groups: Vec<Vec<usize>> =
                groups.into_values().filter(|rows| rows.len() > 1).collect();
            groups
        };
        let one_side = [
            by(&|row| (posture[row], run[row], side[row].clone())),
            by(&|row| (posture[row], 0, side[row].clone())),
        ];
        for groups in one_side {
            if freedom(&groups) >= ENOUGH_REPEATS {
                return Self {
                    groups,
                    are_of_one_side: true,
                };
            }
        }
        Self {
            groups: by(&|row| (posture[row], 0, Vec::new())),
            are_of_one_side: false,
        }
    }

    /// The noise of a stream's residuals over the stated deviation (NaN where there is none). The rounding of the motor
    /// encoders, a `rounding` share of the stated variance, is the same in every repeat. None of too few repeats.
    pub(crate) fn noise(&self, scaled: &[f64], rounding: f64) -> Option<Noise> {
        let (mut squares, mut freedom) = (0.0, 0.0);
        for rows in &self.groups {
            let values: Vec<f64> = rows.iter().map(|&row| scaled[row]).collect();
            let values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
            if values.len() > 1 {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                squares += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
                freedom += (values.len() - 1) as f64;
            }
        }
        if freedom < ENOUGH_REPEATS as f64 {
            return None;
        }
        let ratio = (squares / freedom + rounding).sqrt().max(1e-9);
        Some(Noise::of_postures(ratio, freedom, NoiseSource::Repeats))
    }
}

/// Repeats of several streams of one instrument, where they agree: it has one noise.
pub(crate) fn pooled(streams: &[&Noise]) -> Option<Noise> {
    let agree = |one: &Noise| {
        streams
            .iter()
            .all(|other| !one.is_above(other.ratio, other.freedom))
    };
    if streams.len() < 2 || !streams.iter().all(|noise| agree(noise)) {
        return None;
    }
    let freedom: f64 = streams.iter().map(|noise| noise.freedom).sum();
    let squares = streams
        .iter()
        .map(|noise| noise.freedom * noise.ratio * noise.ratio);
    let ratio = (squares.sum::<f64>() / freedom).sqrt();
    Some(Noise::of_postures(ratio, freedom, NoiseSource::Repeats))
}

fn freedom(groups: &[Vec<usize>]) -> usize {
    groups.iter().map(|rows| rows.len() - 1).sum()
}

/// The first row in the same posture, for each row: within a reading's step, or a small share of each joint's range, and
/// of the same tool and tracker place, as what is wrong with the device shows otherwise at another tool.
fn postures(context: &Context<'_>) -> Vec<usize> {
    let columns = &context.recording.joint;
    let near: Vec<f64> = columns
        .iter()
        .zip(&context.device.joints)
        .map(|(column, joint)| {
            let low = column.iter().copied().fold(f64::INFINITY, f64::min);
            let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let step = joint.reading_quantum_rad().unwrap_or(0.0);
            (SAME_POSTURE * (high - low)).max(1.01 * step)
        })
        .collect();
    let rows = context.rows();
    let mut first: Vec<usize> = (0..rows).collect();
    // sorted by the joint that moves most finely, only neighbours can be the same posture
    let Some(key) = (0..columns.len()).find(|&joint| near[joint] > 0.0) else {
        return first;
    };
    let mut order: Vec<usize> = (0..rows).collect();
    order.sort_by(|&a, &b| columns[key][a].total_cmp(&columns[key][b]).then(a.cmp(&b)));
    let hands = context.recording.hand.as_ref();
    let is_near = |a: usize, b: usize| {
        let mut joints = columns.iter().zip(&near);
        // what one hand shows of a posture does not repeat what another one does
        let is_of_one_hand = hands.is_none_or(|hands| hands[a] == hands[b]);
        joints.all(|(column, near)| (column[a] - column[b]).abs() <= *near)
            && is_of_one_hand
            && context.mount(a) == context.mount(b)
    };
    let mut leaders: Vec<usize> = Vec::new();
    for row in order {
        let recent = leaders.iter().rev();
        let mut recent =
            recent.take_while(|&&leader| columns[key][row] - columns[key][leader] <= near[key]);
        match recent.find(|&&leader| is_near(row, leader)) {
            Some(&leader) => first[row] = leader,
            None => leaders.push(row),
        }
    }
    first
}

/// The run of each row, and the side that each joint came from to its posture.
fn approaches(context: &Context<'_>, posture: &[usize]) -> (Vec<usize>, Vec<Vec<i8>>) {
    let columns = &context.recording.joint;
    let mut run = vec![0; posture.len()];
    let mut side = vec![Vec::new(); posture.len()];
    for (index, rows) in context.runs.iter().enumerate() {
        let mut now: Vec<i8> = Vec::new();
        for row in rows.clone() {
            run[row] = index;
            if row > rows.start && posture[row] != posture[row - 1] {
                let sides = columns.iter().map(|column| {
                    let step = column[row] - column[row - 1];
                    i8::from(step > 0.0) - i8::from(step < 0.0)
                });
                now = sides.collect();
            }
            side[row].clone_from(&now);
        }
    }
    (run, side)
}
