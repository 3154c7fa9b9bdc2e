//! A gain that changes: from an episode on, the position's changes are as many times what they were.
//!
//! Rows after a change obey u q = w + FIR(c) where those before obey q = FIR(c). For given u the rest is linear, so the squares
//! that are left are a quadratic in u, and the likelihood with its Jacobian u per row after has its maximum in closed form
//! (docs/episodes.md).

use std::ops::Range;

use haptical_linalg::{NormalEquations, NormalSolution};

use super::change_points::change_points;
use super::moments::{COLUMNS, CONSTANT, moments, running, taps};
use super::scale::{median, scatter};
use super::series::Joint;
use super::verdict::probability;
use super::{EpisodeFinding, Fault};
use crate::thresholds::{
    CRISP, EPISODE_GAIN, EPISODE_GAIN_NATS, EPISODE_RIDGE, EPISODE_TAPS, FEWEST_EPISODES,
    GAIN_TOLD, NEIGHBOURS, STILL_GAIN, STILL_GAIN_NATS, WRONG_SIDE,
};

/// Columns: a constant, one after the change, the taps, and the position after.
const AFTER: usize = 1;
const POSITION_AFTER: usize = 2 + EPISODE_TAPS + 1;

/// A change of the gain from an episode on, or between two changes of the level; episodes are places among those that show the joint.
pub(super) fn fault(joint: &Joint, least_offset: f64) -> Option<EpisodeFinding> {
    if joint.episodes.len() < FEWEST_EPISODES {
        return None;
    }
    let moments = moments(joint);
    let sums = running(&moments);
    let (episodes, all) = (moments.len(), &sums[moments.len()]);
    let steps = change_points(&joint.levels(), least_offset);
    let between = steps.windows(2).map(|pair| pair[0].at..pair[1].at);
    let after = (NEIGHBOURS..=episodes - NEIGHBOURS).map(|at| at..episodes);
    let splits: Vec<Split> = after
        .chain(between)
        .filter_map(|changed| {
            Split::new(
                &sums[changed.end].plus(&sums[changed.start], -1.0),
                all,
                changed,
                episodes,
            )
        })
        .collect();
    let best = splits.iter().max_by(|a, b| a.nats.total_cmp(&b.nats))?;
    let offset = splits
        .iter()
        .map(|split| split.offset_nats)
        .fold(0.0, f64::max);
    let gained = best.nats - offset;
    let gains: Vec<f64> = joint
        .gains()
        .iter()
        .map(|gain| gain.max(1e-9).ln())
        .collect();
    if !is_one(&gains, best, gained) {
        return None;
    }
    let changed = best.changed.clone();
    // the stretch before is wrong where it is farther from a gain of 1
    let (factor, stretch) = match is_first_wrong(&gains, best) {
        true => (1.0 / best.factor, 0..changed.start),
        false => (best.factor, changed),
    };
    Some(EpisodeFinding {
        fault: Fault::Gain {
            factor,
            sd: factor * best.sd,
        },
        since: stretch.start,
        until: (stretch.end < episodes).then(|| stretch.end - 1),
        probability: probability(gained, episodes),
    })
}

/// Whether the gain before a change that lasts to the end is as much farther from 1 as the change is large.
fn is_first_wrong(logs: &[f64], split: &Split) -> bool {
    let size = |part: &[f64]| median(&mut part.to_vec()).abs();
    let (before, after) = (
        size(&logs[..split.changed.start]),
        size(&logs[split.changed.clone()]),
    );
    scatter(logs) <= GAIN_TOLD * split.factor.ln().abs()
        && split.changed.end == logs.len()
        && before - after >= WRONG_SIDE * split.factor.ln().abs()
}

/// Whether a change is large and clear enough. Of a joint that moves enough the episodes next to the change must have different gains,
/// each by itself; one that hardly moves must gain more, and by a larger factor.
fn is_one(logs: &[f64], split: &Split, gained: f64) -> bool {
    let size = split.factor.ln();
    if scatter(logs) > GAIN_TOLD * size.abs() {
        return gained >= STILL_GAIN_NATS && size.abs() >= STILL_GAIN.ln();
    }
    let middle = |part: &[f64]| median(&mut part.to_vec());
    let (start, end) = (
        split.changed.start,
        split.changed.end.min(split.changed.start + NEIGHBOURS),
    );
    let border = middle(&logs[start..end]) - middle(&logs[start.saturating_sub(NEIGHBOURS)..start]);
    let shift = middle(&logs[split.changed.clone()]) - middle(&logs[..start]);
    let is_crisp = (border / size).min(shift / size) > CRISP;
    gained >= EPISODE_GAIN_NATS && size.abs() >= EPISODE_GAIN.ln() && is_crisp
}

/// The fit of a change in a stretch of episodes.
#[derive(Debug)]
struct Split {
    changed: Range<usize>,
    factor: f64,
    /// Standard deviation of its logarithm.
    sd: f64,
    /// What it gains \[nats\] over no change, an episode counting as one observation: what laws leave is no noise of rows.
    nats: f64,
    /// What an offset gains.
    offset_nats: f64,
}

impl Split {
    fn new(
        after: &NormalEquations,
        all: &NormalEquations,
        changed: Range<usize>,
        episodes: usize,
    ) -> Option<Self> {
        let joined = joined(&all.plus(after, -1.0), after);
        let fitted: Vec<usize> = (0..POSITION_AFTER).collect();
        let [bb, ba, aa] = rest(&joined, &fitted);
        let without: Vec<usize> = fitted
            .iter()
            .copied()
            .filter(|column| *column != AFTER)
            .collect();
        let [b0, m0, a0] = rest(&joined, &without);
        let (rows, after_rows) = (
            all.product(CONSTANT, CONSTANT),
            after.product(CONSTANT, CONSTANT),
        );
        let none = b0 + 2.0 * m0 + a0;
        // (n - m) aa u^2 + (n - 2 m) ba u - m bb = 0
        let (first, second, third) = (
            (rows - after_rows) * aa,
            (rows - 2.0 * after_rows) * ba,
            -after_rows * bb,
        );
        let root = (second * second - 4.0 * first * third).max(0.0).sqrt();
        let u = (root - second) / (2.0 * first);
        let left = bb + 2.0 * ba * u + aa * u * u;
        let observations = 0.5 * episodes as f64;
        let nats =
            |left: f64, share: f64| observations * (none / left).ln() + episodes as f64 * share;
        let all_valid = u.is_finite() && u > 0.0 && left > 0.0 && none > 0.0;
        all_valid.then(|| Self {
            changed,
            factor: 1.0 / u,
            sd: (left / (aa * episodes as f64)).sqrt() / u,
            nats: nats(left, after_rows / rows * u.ln()),
            offset_nats: nats(bb + 2.0 * ba + aa, 0.0),
        })
    }
}

/// Products of the constants and taps of all episodes, and of the position before (the target) and after apart.
fn joined(before: &NormalEquations, after: &NormalEquations) -> NormalEquations {
    let from = |column: usize| match column {
        0 | AFTER => CONSTANT,
        POSITION_AFTER.. => COLUMNS,
        _ => taps().start + column - 2,
    };
    let target = POSITION_AFTER + 1;
    let is_after = |column: usize| column == AFTER || column == POSITION_AFTER;
    NormalEquations::from_products(target, |a, b| {
        let of = |sums: &NormalEquations| sums.product(from(a), from(b));
        match (a == target || b == target, is_after(a) || is_after(b)) {
            (true, true) => 0.0,
            (true, false) => of(before),
            (false, true) => of(after),
            (false, false) => of(before) + of(after),
        }
    })
}

/// Squares and product of the position before and after in what some columns leave: before, both, after.
fn rest(joined: &NormalEquations, columns: &[usize]) -> [f64; 3] {
    let fit: NormalSolution = joined.solve(columns, |column| {
        EPISODE_RIDGE * joined.product(column, column)
    });
    let left = joined.across(&fit, &[joined.columns(), POSITION_AFTER]);
    [left[(0, 0)], left[(0, 1)], left[(1, 1)]]
}
