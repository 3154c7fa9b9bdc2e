//! Products of a joint's regressors, summed over each episode: any split of the episodes is fitted without their rows.

use std::ops::Range;

use haptical_linalg::NormalEquations;

use super::scale::{NORMAL_MEDIAN, median};
use super::series::Joint;
use crate::thresholds::{
    EPISODE_LEAD, EPISODE_PAST, EPISODE_RIDGE, EPISODE_TAPS, HELD_REPEATS, ROBUST_FREEDOM,
};

/// Past readings, the constant, and the command from some rows ahead to the last tap and as many rows behind it.
pub(super) const COLUMNS: usize = EPISODE_PAST + 1 + EPISODE_TAPS + 1 + 2 * EPISODE_LEAD;
/// The constant's column.
pub(super) const CONSTANT: usize = EPISODE_PAST;
const FIRST_TAP: usize = EPISODE_PAST + 1;

/// Sums of each episode: the readings before, the constant, the command's taps; the target is the position.
pub(super) fn moments(joint: &Joint) -> Vec<NormalEquations> {
    let rows = Rows::new(joint);
    let all = 0..joint.episodes.len();
    all.map(|place| rows.sums(place, |_| 1.0)).collect()
}

/// The same with less weight for rows that the others' regression misses by much (those of a normal mixture, as for Student's t with
/// as many degrees of freedom): a joint that sticks and slips has few rows that would outweigh all others.
pub(super) fn weighted_moments(joint: &Joint, equal: &[NormalEquations]) -> Vec<NormalEquations> {
    let mut sums = NormalEquations::new(COLUMNS);
    equal.iter().for_each(|episode| sums.add(episode, 1.0));
    let columns: Vec<usize> = (0..=CONSTANT).chain(taps()).collect();
    let fit = sums.solve(&columns, |column| {
        EPISODE_RIDGE * sums.product(column, column)
    });
    let rows = Rows::new(joint);
    let missed = |values: &[f64]| {
        let pairs = columns.iter().zip(fit.coefficients());
        values[COLUMNS]
            - pairs
                .map(|(column, factor)| values[*column] * factor)
                .sum::<f64>()
    };
    let mut sizes = Vec::new();
    for place in 0..joint.episodes.len() {
        rows.each(place, |values| sizes.push(missed(values).abs()));
    }
    let scale = ROBUST_FREEDOM.sqrt() * NORMAL_MEDIAN * median(&mut sizes);
    let weight = |values: &[f64]| 1.0 / (1.0 + (missed(values) / scale).powi(2));
    (0..joint.episodes.len())
        .map(|place| rows.sums(place, weight))
        .collect()
}

/// The rows of a regression.
struct Rows<'a> {
    joint: &'a Joint,
    /// Positions and commands are taken from here: sums of squares of large numbers lose digits.
    middle: f64,
    /// Whether the sensor repeats its readings: then only the new ones say when the joint was where.
    is_held: bool,
}

impl<'a> Rows<'a> {
    fn new(joint: &'a Joint) -> Self {
        let rows = || joint.episodes.iter().flat_map(|(_, rows)| joint.rows(rows));
        Self {
            joint,
            middle: rows().map(|row| joint.command[row]).sum::<f64>()
                / rows().count().max(1) as f64,
            is_held: joint.repeated() > HELD_REPEATS,
        }
    }

    /// Goes through the rows of an episode.
    fn each(&self, place: usize, mut of: impl FnMut(&[f64; COLUMNS + 1])) {
        let (joint, middle) = (self.joint, self.middle);
        let rows = &joint.episodes[place].1;
        let (behind, ahead) = (EPISODE_TAPS + EPISODE_LEAD, EPISODE_LEAD);
        let mut values = [0.0; COLUMNS + 1];
        for row in rows.start + behind..rows.end.saturating_sub(ahead) {
            if self.is_held && joint.position[row] == joint.position[row - 1] {
                continue;
            }
            for (value, before) in values.iter_mut().zip(1..=EPISODE_PAST) {
                *value = joint.position[row - before] - middle;
            }
            values[CONSTANT] = 1.0;
            let taps = joint.command[row - behind..=row + ahead].iter().rev();
            for (value, command) in values[FIRST_TAP..].iter_mut().zip(taps) {
                *value = command - middle;
            }
            values[COLUMNS] = joint.position[row] - middle;
            if values.iter().all(|value| value.is_finite()) {
                of(&values);
            }
        }
    }

    fn sums(&self, place: usize, weight: impl Fn(&[f64]) -> f64) -> NormalEquations {
        let mut sums = NormalEquations::new(COLUMNS);
        self.each(place, |values| {
            let root = weight(values).sqrt();
            match root < 1.0 {
                true => sums.add_row(&values.map(|value| root * value)),
                false => sums.add_row(values),
            }
        });
        sums
    }
}

/// Columns of the command's taps without a delay.
pub(super) fn taps() -> Range<usize> {
    FIRST_TAP + EPISODE_LEAD..FIRST_TAP + EPISODE_LEAD + EPISODE_TAPS + 1
}

/// Sums of past readings, constant and taps of a command that is later by some rows, between rows along straight lines.
pub(super) fn late(sums: &NormalEquations, rows: f64) -> NormalEquations {
    let (whole, part) = (rows.floor(), rows - rows.floor());
    let columns = FIRST_TAP + EPISODE_TAPS + 1;
    // where a column comes from, and the next one's part
    let from = |column: usize| match column {
        _ if column == columns => (COLUMNS, 0.0),
        0..FIRST_TAP => (column, 0.0),
        _ => (
            (column + EPISODE_LEAD).saturating_add_signed(whole as isize),
            part,
        ),
    };
    NormalEquations::from_products(columns, |a, b| {
        let ((a, share_a), (b, share_b)) = (from(a), from(b));
        let next = |b: usize, share: f64, a: usize| match share {
            0.0 => sums.product(a, b),
            _ => (1.0 - share) * sums.product(a, b) + share * sums.product(a, b + 1),
        };
        match share_a {
            0.0 => next(b, share_b, a),
            _ => (1.0 - share_a) * next(b, share_b, a) + share_a * next(b, share_b, a + 1),
        }
    })
}

/// Sums up to each place: of the episodes before it.
pub(super) fn running(moments: &[NormalEquations]) -> Vec<NormalEquations> {
    let mut sums = NormalEquations::new(COLUMNS);
    let mut all = vec![sums.clone()];
    for episode in moments {
        sums.add(episode, 1.0);
        all.push(sums.clone());
    }
    all
}
