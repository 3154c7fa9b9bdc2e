//! Since when standardised block features are others: a step or a ramp, and an interval.

use crate::reference::Feature;

/// How a change came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// At once.
    Step,
    /// Growing ever since.
    Ramp,
}

/// Since when, in blocks from the oldest one kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// First block that is another; the median of its probability.
    pub first: usize,
    /// Interval that holds it with the probability asked for.
    pub interval: [usize; 2],
    /// The likelier shape.
    pub shape: Shape,
    /// Probability of that shape.
    pub shape_probability: f64,
    /// Whether it may lie before the oldest block kept.
    pub may_be_older: bool,
}

/// Standard deviations of a shift beforehand, in those of a block: its order of magnitude is unknown.
const SHIFT_SDS: [f64; 3] = [0.1, 1.0, 10.0];
/// How many parts of the first block a step is tried to begin at.
const PARTS: usize = 4;
/// Variances of a block after the change that are tried, in those before it: what a joint or a link does wrong is another at each
/// posture, so that blocks scatter.
const SCATTERS: [f64; 9] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];
/// Standard deviations that the margin of a reference's mean is.
const MARGIN_SDS: f64 = 2.0;

/// Probabilities of every first block, given that there is one: uniform beforehand, each feature shifted at once or on a ramp, and
/// scattering more from then on by a factor of its own (Smith 1975, with the shift integrated out). What comes at once comes within its
/// first block, so that this one may show a part of it. How well the reference knows a feature, and what its blocks share, is
/// in the interval (docs/equations.md, A calibration that is watched).
///
/// `blocks` holds the features of block 0, of block 1, ..., less the mean and over the standard deviation of `reference`; NaN is no
/// reading. The change is in no block after `latest`. `level` is the probability of the interval. None without blocks.
///
/// # Examples
/// ```
/// use haptical_monitor::{Feature, Shape, change};
/// let shift = |k: i32| if k < 40 { 0.0 } else { 4.0 };
/// let blocks: Vec<[f64; 1]> = (0..60).map(|k| [f64::from(k % 3 - 1) + shift(k)]).collect();
/// let reference = Feature { mean: 0.0, sd: 1.0, margin: 0.2, widened: 1.1, share: 1.0 };
/// let found = change(blocks.iter().map(|block| &block[..]), &[reference], None, 0.95).unwrap();
/// assert_eq!((found.first, found.shape), (40, Shape::Step));
/// ```
pub fn change<'b>(
    blocks: impl Iterator<Item = &'b [f64]>,
    reference: &[Feature],
    latest: Option<usize>,
    level: f64,
) -> Option<Change> {
    // at the widest that the reference allows, as in the test
    let widest = |block: &[f64]| -> Vec<f64> {
        let pairs = block.iter().zip(reference);
        pairs.map(|(value, own)| value / own.widened).collect()
    };
    let features: Vec<Vec<f64>> = blocks.map(widest).collect();
    let blocks = features.len();
    let mut all = vec![Sums::default(); reference.len()];
    for block in &features {
        (all.iter_mut().zip(block)).for_each(|(all, value)| all.add(*value, 0.0));
    }
    let mut since = vec![Sums::default(); reference.len()];
    // logarithms of the weights, newest block first
    let mut weights: Vec<[f64; 2]> = Vec::with_capacity(blocks);
    for (back, block) in features.iter().rev().enumerate() {
        let length = back as f64 + 1.0;
        let mut ramps = 0.0;
        let mut steps = [0.0; PARTS];
        let sums = since.iter_mut().zip(&all);
        for ((value, feature), (since, all)) in block.iter().zip(reference).zip(sums) {
            since.add(*value, back as f64);
            let is_read = value.is_finite();
            let first = if is_read { *value } else { 0.0 };
            for (step, part) in steps.iter_mut().zip(1..) {
                let part = f64::from(part) / PARTS as f64;
                let lost = if is_read { 1.0 - part } else { 0.0 };
                let square = since.count - lost * (1.0 + part);
                let shape = [since.values - lost * first, since.count - lost, square];
                *step += since.log_evidence(all, feature, shape);
            }
            let square = (length + 1.0) * (2.0 * length + 1.0) / (6.0 * length);
            let shape = [
                since.values - since.by_age / length,
                0.5 * (length + 1.0) * since.count / length,
                square * since.count / length,
            ];
            ramps += since.log_evidence(all, feature, shape);
        }
        weights.push([log_mean(steps), ramps]);
    }
    weights.reverse();
    weights.truncate(latest.map_or(blocks, |latest| latest + 1));
    let largest = weights.iter().flatten().copied().fold(f64::MIN, f64::max);
    let each: Vec<[f64; 2]> = weights
        .iter()
        .map(|own| own.map(|weight| (weight - largest).exp()))
        .collect();
    let total: f64 = each.iter().flatten().sum();
    let tail = 0.5 * (1.0 - level);
    let at = |share: f64| {
        let mut sum = 0.0;
        let mut all = each.iter();
        let first = all.position(|own| {
            sum += (own[0] + own[1]) / total;
            sum >= share
        });
        first.unwrap_or(blocks.saturating_sub(1))
    };
    (blocks > 0).then(|| {
        let steps: f64 = each.iter().map(|own| own[0]).sum::<f64>() / total;
        let interval = [at(tail), at(1.0 - tail)];
        Change {
            first: at(0.5),
            interval,
            shape: if steps >= 0.5 {
                Shape::Step
            } else {
                Shape::Ramp
            },
            shape_probability: steps.max(1.0 - steps),
            may_be_older: interval[0] == 0,
        }
    })
}

/// Sums over a feature's readings since a block.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    values: f64,
    squares: f64,
    /// Of values times age, which is counted from the newest block on.
    by_age: f64,
}

impl Sums {
    /// Adds a reading; NaN is none.
    fn add(&mut self, value: f64, age: f64) {
        if value.is_finite() {
            self.count += 1.0;
            self.values += value;
            self.squares += value * value;
            self.by_age += age * value;
        }
    }

    /// Logarithm of the evidence for a shift `b` times a shape `x` since a block and for any of the scatters, over that for neither, where
    /// all blocks may be off by what the reference does not know; `[x.z, sum of x, x.x]`.
    fn log_evidence(&self, all: &Self, feature: &Feature, [xz, x, xx]: [f64; 3]) -> f64 {
        let [count, values] = [all.count - self.count, all.values - self.values];
        let offset = (MARGIN_SDS * feature.widened / feature.margin).powi(2);
        let of_size = SHIFT_SDS.map(|sd| {
            let prior = sd.powi(-2);
            log_mean(SCATTERS.map(|scatter| {
                // precision of the offset and of the shift
                let [own, both, of_shift] = [
                    offset + count + self.count / scatter,
                    x / scatter,
                    prior + xx / scatter,
                ];
                let [a, b] = [values + self.values / scatter, xz / scatter];
                let determinant = own * of_shift - both * both;
                let explained = of_shift * a * a - 2.0 * both * a * b + own * b * b;
                let shifted = explained / determinant - (determinant / (offset * prior)).ln();
                let scattered = self.squares * (1.0 - 1.0 / scatter)
                    - feature.share * self.count * scatter.ln();
                0.5 * (shifted + scattered)
            }))
        });
        log_mean(of_size)
    }
}

/// Logarithm of the mean of numbers of which these are the logarithms.
fn log_mean<const N: usize>(logarithms: [f64; N]) -> f64 {
    let largest = logarithms.iter().copied().fold(f64::MIN, f64::max);
    let sum: f64 = logarithms.iter().map(|own| (own - largest).exp()).sum();
    largest + (sum / N as f64).ln()
}
