//! What residuals are while the calibration is true: means and sizes of block features, and how far they are known.

use haptical_metrics::{chi_square_quantile, student_t_quantile};

use crate::block::{BASE_ROWS, Blocks, Sums};
use crate::detector::Detector;
use crate::error::MonitorError;

/// Fewest blocks that a reference rests on.
pub(crate) const LEAST_BLOCKS: usize = 64;
/// Most that blocks may share with the next one, as a part of the variance that is judged, its own uncertainty added.
const MOST_WITH_NEXT: f64 = 0.2;
/// The same with all later ones. What they share makes the variance of a long mean larger, at most three times, and counts in it.
const MOST_SHARED: f64 = 1.0;
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
    /// What a block shares with later ones: the sum of the correlations over all lags.
    pub shared: f64,
    /// What the true mean may be off, in `sd`: what is no larger than this does not count.
    pub margin: f64,
    /// What the true standard deviation may be, over `sd`.
    pub widened: f64,
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
    /// The shortest blocks whose features are as good as independent, and by which the reference itself is no alarm; none where the
    /// rows so far are too few for that.
    ///
    /// `miss` is the probability that any of the margins is too small, `tolerance` what a mean may be off besides, one number a
    /// component in its scale.
    pub(crate) fn of(
        blocks: &Blocks,
        components: usize,
        miss: f64,
        tolerance: &[f64],
    ) -> Result<Option<Self>, MonitorError> {
        let level = 1.0 - miss / (2 * components) as f64;
        let wanted = Wanted { level, tolerance };
        let mut factor = 1;
        while blocks.len() / factor >= LEAST_BLOCKS {
            let series: Vec<Vec<Sums>> = (0..components)
                .map(|component| blocks.merged(component, factor).collect())
                .collect();
            let found = Self::of_blocks(&series, blocks.rows * factor, &wanted)?;
            if let Some(found) = found
                && !found.is_alarmed_by(&series)
            {
                return Ok(Some(found));
            }
            factor *= 2;
        }
        Ok(None)
    }

    /// The reference of blocks of so many rows; none where they are not independent.
    fn of_blocks(
        series: &[Vec<Sums>],
        rows: usize,
        wanted: &Wanted<'_>,
    ) -> Result<Option<Self>, MonitorError> {
        let mut found = Self {
            block_rows: rows,
            blocks: series.first().map_or(0, Vec::len),
            features: Vec::with_capacity(series.len()),
            readings: Vec::with_capacity(series.len()),
        };
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
            if readings < LEAST_READINGS {
                return Ok(None);
            }
            let own: Vec<[f64; 2]> = sums
                .iter()
                .filter_map(|sums| sums.features(readings))
                .collect();
            let pair = feature_pair(&own, readings, wanted.level, *tolerance)?;
            if pair
                .iter()
                .flatten()
                .any(|(_, is_independent)| !is_independent)
            {
                return Ok(None);
            }
            found
                .features
                .push(pair.map(|pair| pair.map(|(feature, _)| feature)));
        }
        Ok(found.features.iter().any(Option::is_some).then_some(found))
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

/// Both features of a component, and whether blocks are as good as independent in them; none with too few blocks.
fn feature_pair(
    own: &[[f64; 2]],
    readings: f64,
    level: f64,
    tolerance: f64,
) -> Result<Option<[(Feature, bool); 2]>, MonitorError> {
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

fn feature(
    values: &[f64],
    least: f64,
    level: f64,
    tolerance: f64,
) -> Result<(Feature, bool), MonitorError> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let left: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let variance = left.iter().map(|own| own * own).sum::<f64>() / (count - 1.0);
    let judged = variance.max(tolerance * tolerance);
    let (with_next, shared) = shared(&left, MOST_SHARED * judged / variance);
    // the estimate of a correlation is off by 1 / sqrt(count)
    let uncertain = 1.0 / count.sqrt();
    let most = shared + uncertain;
    // what blocks share adds to the variance of long means, and what is within the tolerance does not count
    let sd = (variance * (1.0 + 2.0 * most.max(0.0))).sqrt();
    let sd = sd.max(tolerance).max(least);
    let low = chi_square_quantile(0.5 * (1.0 - level), count - 1.0)?;
    let found = Feature {
        mean,
        sd,
        shared,
        margin: student_t_quantile(level, count - 1.0)? / count.sqrt() + tolerance / sd,
        widened: (low / (count - 1.0)).sqrt().recip(),
    };
    let part = variance / judged;
    let is_independent =
        (with_next + uncertain) * part <= MOST_WITH_NEXT && most * part <= MOST_SHARED;
    Ok((found, is_independent))
}

/// Correlation with the next value, and the sum of the correlations over all lags from 1 on, of values about their mean: pairs of
/// neighbouring lags are added as long as they are above 0, as those of a chain that can run backwards are (Geyer 1992). The sum
/// ends where it is above `enough`.
fn shared(left: &[f64], enough: f64) -> (f64, f64) {
    let square: f64 = left.iter().map(|own| own * own).sum();
    if square <= 0.0 {
        return (0.0, 0.0);
    }
    let about = |lag: usize| {
        let pairs = left.iter().zip(&left[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>() / square
    };
    let next = about(1);
    let mut sum = next;
    for pair in 1..left.len() / 4 {
        let both = about(2 * pair) + about(2 * pair + 1);
        if both <= 0.0 || sum > enough {
            break;
        }
        sum += both;
    }
    (next, sum)
}
