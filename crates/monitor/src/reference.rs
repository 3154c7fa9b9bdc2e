//! What residuals are while the calibration is true: means and sizes of block features, and how far they are known.

use haptical_metrics::{chi_square_quantile, student_t_quantile};

use crate::block::{BASE_ROWS, Blocks, Sums};
use crate::detector::Detector;
use crate::error::MonitorError;

/// Fewest blocks that a reference rests on.
pub(crate) const LEAST_BLOCKS: usize = 64;
/// Most that the variance of a long mean may be, in that of the mean of independent blocks. It counts, so that blocks may share a part.
const MOST_LONG: f64 = 2.0;
/// The same where neighbours are alike and nothing is known of farther blocks: two times the correlation of neighbours, 1, and 1.
const ALL_LONG: f64 = 3.0;
/// Fewest readings of a block, on average: the mean of fewer is not normal enough.
const LEAST_READINGS: f64 = 0.5 * BASE_ROWS as f64;
/// Least standard deviation of a block's mean, as a share of that of white noise: a sensor that stood on one count has none.
const LEAST_SHARE: f64 = 0.1;

/// One feature of one component in the reference, in units of the component's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Its mean over the blocks.
    pub mean: f64,
    /// Standard deviation of a block, memory beyond the block included: of `k` blocks the mean has it over the root of `k`. At least
    /// what the mean may be off without counting.
    pub sd: f64,
    /// What the true mean may be off, in `sd`: what is no larger than this does not count.
    pub margin: f64,
    /// What the true standard deviation may be, over `sd`.
    pub widened: f64,
    /// How many independent blocks a block counts for: its variance over the square of `sd`, at most 1.
    pub share: f64,
}

/// A reference: how long a block is, and what its features are.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Rows of a block.
    pub block_rows: usize,
    /// Blocks that it rests on.
    pub blocks: usize,
    /// Of each component its mean and the cube root of its mean square; none of a component with too few readings.
    pub features: Vec<Option<[Feature; 2]>>,
    /// Readings of each component in a block that has any, on average.
    pub readings: Vec<f64>,
}

/// What a reference is asked for.
struct Wanted<'a> {
    /// Level of each margin.
    level: f64,
    /// What the mean of each component may be off besides, in its scale.
    tolerance: &'a [f64],
}

impl Reference {
    /// The shortest blocks whose variance holds what they share with later ones, and by which the reference itself is no alarm; where the
    /// rows so far are too few for that, how many times as many are needed, about.
    ///
    /// `miss` is the probability that any of the margins is too small, `tolerance` what a mean may be off besides, one number a
    /// component in its scale.
    pub(crate) fn of(
        blocks: &Blocks,
        components: usize,
        miss: f64,
        tolerance: &[f64],
    ) -> Result<Result<Self, f64>, MonitorError> {
        let level = 1.0 - miss / (2 * components) as f64;
        let wanted = Wanted { level, tolerance };
        let mut factor = 1;
        let mut longer = 2.0;
        while blocks.len() / factor >= LEAST_BLOCKS {
            let series: Vec<Vec<Sums>> = (0..components)
                .map(|component| blocks.merged(component, factor).collect())
                .collect();
            longer = match Self::of_blocks(&series, blocks.rows * factor, &wanted)? {
                Ok(found) if !found.is_alarmed_by(&series) => return Ok(Ok(found)),
                Ok(_) => 2.0,
                // the length of a block doubles from one to the next
                Err(longer) => longer * (2 * LEAST_BLOCKS * factor) as f64 / blocks.len() as f64,
            };
            factor *= 2;
        }
        Ok(Err(longer))
    }

    /// The reference of blocks of so many rows; how many times as long they must be where they share too much or are read too seldom.
    fn of_blocks(
        series: &[Vec<Sums>],
        rows: usize,
        wanted: &Wanted<'_>,
    ) -> Result<Result<Self, f64>, MonitorError> {
        let mut found = Self {
            block_rows: rows,
            blocks: series.first().map_or(0, Vec::len),
            features: Vec::with_capacity(series.len()),
            readings: Vec::with_capacity(series.len()),
        };
        let mut longer = 1.0_f64;
        for (sums, tolerance) in series.iter().zip(wanted.tolerance) {
            let read = sums.iter().filter(|own| own.count > 0);
            let all: f64 = read.clone().map(|own| f64::from(own.count)).sum();
            let readings = all / (read.count() as f64).max(1.0);
            found.readings.push(readings);
            // of longer blocks there would be too few
            if all < LEAST_READINGS * LEAST_BLOCKS as f64 {
                found.features.push(None);
                continue;
            }
            longer = longer.max(LEAST_READINGS / readings);
            let own: Vec<[f64; 2]> = sums
                .iter()
                .filter_map(|sums| sums.features(readings))
                .collect();
            let pair = feature_pair(&own, readings, wanted.level, *tolerance)?;
            for (_, long) in pair.iter().flatten() {
                // as blocks get longer the correlation of neighbours falls from 1, in proportion at first
                longer = longer.max((ALL_LONG - MOST_LONG) / (ALL_LONG - long).max(0.1));
            }
            found
                .features
                .push(pair.map(|pair| pair.map(|(feature, _)| feature)));
        }
        if longer > 1.0 {
            return Ok(Err(longer));
        }
        // no channel has readings enough
        let is_read = found.features.iter().any(Option::is_some);
        Ok(if is_read { Ok(found) } else { Err(2.0) })
    }

    /// Whether the test that is to judge with this reference takes the reference itself for an alarm, at the rate of one false alarm in
    /// its length. Where the law holds for its blocks that is rare; where a few of them hold most of a scatter it is not.
    fn is_alarmed_by(&self, series: &[Vec<Sums>]) -> bool {
        let mut detector = Detector::new(self);
        let most = self.blocks as f64;
        let mut judged = vec![None; series.len()];
        (0..self.blocks).any(|block| {
            for (component, own) in judged.iter_mut().enumerate() {
                *own = self.standardised(component, series[component][block]);
            }
            detector.push(self, &judged);
            detector.evidence() >= most
        })
    }

    /// A block's features of a component in standard deviations from the reference; none with too few readings.
    pub(crate) fn standardised(&self, component: usize, sums: Sums) -> Option<[f64; 2]> {
        let [of_mean, of_size] = self.features[component]?;
        let usual = self.readings[component];
        let [mean, size] = sums.features(usual)?;
        // fewer readings in a block: its features scatter more
        let filled = (f64::from(sums.count) / usual).min(1.0).sqrt();
        Some([
            filled * (mean - of_mean.mean) / of_mean.sd,
            filled * (size - of_size.mean) / of_size.sd,
        ])
    }
}

/// Both features of a component, each with the variance of a long mean in that of the mean of independent blocks; none with too few blocks.
fn feature_pair(
    own: &[[f64; 2]],
    readings: f64,
    level: f64,
    tolerance: f64,
) -> Result<Option<[(Feature, f64); 2]>, MonitorError> {
    if own.len() < LEAST_BLOCKS {
        return Ok(None);
    }
    let least = LEAST_SHARE / readings.sqrt();
    let column = |which: usize| own.iter().map(|pair| pair[which]).collect::<Vec<f64>>();
    let means = feature(&column(0), least, level, tolerance)?;
    let sizes = column(1);
    let size = sizes.iter().sum::<f64>() / sizes.len() as f64;
    // a mean that is off by the tolerance makes the mean square larger by this
    let grown = tolerance * (tolerance + 2.0 * means.0.mean.abs());
    let grown = (size.powi(3) + grown).cbrt() - size;
    Ok(Some([means, feature(&sizes, least, level, grown)?]))
}

/// The feature of blocks with these values, and the variance of a long mean in that of the mean of independent blocks.
fn feature(
    values: &[f64],
    least: f64,
    level: f64,
    tolerance: f64,
) -> Result<(Feature, f64), MonitorError> {
    let count = values.len() as f64;
    let [mean, variance, _] = moments(values);
    let long = long_variance(values);
    // what is within the tolerance does not count
    let sd = long.sqrt().max(tolerance).max(least);
    let low = chi_square_quantile(0.5 * (1.0 - level), count - 1.0)?;
    let found = Feature {
        mean,
        sd,
        margin: student_t_quantile(level, count - 1.0)? / count.sqrt() + tolerance / sd,
        widened: (low / (count - 1.0)).sqrt().recip(),
        share: variance / (sd * sd),
    };
    let judged = variance.max(tolerance * tolerance);
    Ok((found, long / judged.max(f64::MIN_POSITIVE)))
}

/// Variance of the mean of many values, times their number: the largest that means of 1, 2, 4, ... values show, each with what neighbours
/// may share, one standard error added.
fn long_variance(values: &[f64]) -> f64 {
    let mut means = values.to_vec();
    let (mut length, mut largest) = (1.0, 0.0_f64);
    while means.len() >= LEAST_BLOCKS {
        let [_, variance, next] = moments(&means);
        let shared = next + (means.len() as f64).sqrt().recip();
        largest = largest.max(length * variance * (1.0 + 2.0 * shared.max(0.0)));
        means = means
            .chunks_exact(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        length *= 2.0;
    }
    largest
}

/// Mean, variance, and correlation with the next value.
fn moments(values: &[f64]) -> [f64; 3] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let pairs = values
        .windows(2)
        .map(|pair| (pair[0] - mean) * (pair[1] - mean));
    let next = pairs.sum::<f64>() / square.max(f64::MIN_POSITIVE);
    [mean, square / (count - 1.0), next]
}
