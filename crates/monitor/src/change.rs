//! Since when standardised block features are others: a step or a ramp, and an interval.

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

/// Standard deviation of a shift beforehand, in those of a block.
const SHIFT_SD: f64 = 10.0;
/// How many parts of the first block a step is tried to begin at.
const PARTS: usize = 4;
/// Variances of a block after the change that are tried, in those before it: what a joint or a link does wrong is another at each
/// posture, so that blocks scatter.
const SCATTERS: [f64; 5] = [1.0, 4.0, 16.0, 64.0, 256.0];

/// Probabilities of every first block, given that there is one: uniform beforehand, each feature shifted by a normal draw of its
/// own, at once or on a ramp, and scattering more from then on by a factor of its own (Smith 1975, with the shift integrated out).
/// What comes at once comes within its first block, so that this one may show a part of it.
///
/// `features` holds the features of block 0, of block 1, ...; each is standard normal before the change, NaN is no reading. The
/// change is in no block after `latest`. `level` is the probability of the interval. None without blocks.
///
/// # Examples
/// ```
/// use haptical_monitor::{Shape, change};
/// let shift = |k: i32| if k < 40 { 0.0 } else { 4.0 };
/// let blocks: Vec<[f64; 1]> = (0..60).map(|k| [f64::from(k % 3 - 1) + shift(k)]).collect();
/// let found = change(blocks.iter().map(|block| &block[..]), 1, None, 0.95).unwrap();
/// assert_eq!((found.first, found.shape), (40, Shape::Step));
/// ```
pub fn change<'b>(
    features: impl DoubleEndedIterator<Item = &'b [f64]> + ExactSizeIterator,
    width: usize,
    latest: Option<usize>,
    level: f64,
) -> Option<Change> {
    let blocks = features.len();
    let mut sums = vec![Sums::default(); width];
    // logarithms of the weights, newest block first
    let mut weights: Vec<[f64; 2]> = Vec::with_capacity(blocks);
    for (back, block) in features.rev().enumerate() {
        let length = back as f64 + 1.0;
        let mut ramps = 0.0;
        let mut steps = [0.0; PARTS];
        for (sums, value) in sums.iter_mut().zip(block) {
            let is_read = value.is_finite();
            let first = if is_read { *value } else { 0.0 };
            if is_read {
                sums.add(*value, back as f64);
            }
            for (step, part) in steps.iter_mut().zip(1..) {
                let part = f64::from(part) / PARTS as f64;
                let lost = if is_read { 1.0 - part * part } else { 0.0 };
                *step += sums.log_evidence(sums.values - (1.0 - part) * first, sums.count - lost);
            }
            ramps += sums.log_evidence(
                sums.values - sums.by_age / length,
                (length + 1.0) * (2.0 * length + 1.0) / (6.0 * length) * sums.count / length,
            );
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
    fn add(&mut self, value: f64, age: f64) {
        self.count += 1.0;
        self.values += value;
        self.squares += value * value;
        self.by_age += age * value;
    }

    /// Logarithm of the evidence for a shift `b ~ N(0, SHIFT_SD^2)` times a shape with `product = sum s z` and `square = sum s^2`,
    /// and for any of the scatters, over that for neither.
    fn log_evidence(&self, product: f64, square: f64) -> f64 {
        let prior = SHIFT_SD * SHIFT_SD;
        log_mean(SCATTERS.map(|scatter| {
            let (product, square) = (product / scatter, square / scatter);
            let shift = product * product / (square + 1.0 / prior) - (prior * square).ln_1p();
            let scattered = self.squares * (1.0 - 1.0 / scatter) - self.count * scatter.ln();
            0.5 * (shift + scattered)
        }))
    }
}

/// Logarithm of the mean of numbers of which these are the logarithms.
fn log_mean<const N: usize>(logarithms: [f64; N]) -> f64 {
    let largest = logarithms.iter().copied().fold(f64::MIN, f64::max);
    let sum: f64 = logarithms.iter().map(|own| (own - largest).exp()).sum();
    largest + (sum / N as f64).ln()
}
