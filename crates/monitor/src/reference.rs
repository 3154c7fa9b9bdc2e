//! What residuals are while the calibration is true: means and sizes of block features, and how far they are known.

use haptical_metrics::{chi_square_quantile, student_t_quantile};

use crate::block::Blocks;
use crate::error::MonitorError;

/// Fewest blocks that a reference rests on.
pub(crate) const LEAST_BLOCKS: usize = 64;
/// Most that successive blocks may be correlated, its own uncertainty added.
const MOST_CORRELATION: f64 = 0.2;
/// Least standard deviation of a block's mean, as a share of that of white noise: a sensor that stood on one count has none.
const LEAST_SHARE: f64 = 0.1;

/// One feature of one component in the reference, in units of the component's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Its mean over the blocks.
    pub mean: f64,
    /// Standard deviation of a block, memory beyond the block included: of `k` blocks the mean has it over the root of `k`.
    pub sd: f64,
    /// Correlation of successive blocks.
    pub correlation: f64,
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
}

impl Reference {
    /// The shortest blocks whose features are as good as independent, and their features; none where the rows so far are too
    /// few for that.
    ///
    /// `miss` is the probability that any of the margins is too small, `tolerance` what a mean may be off besides, one number a
    /// component in its scale.
    pub(crate) fn of(
        blocks: &Blocks,
        components: usize,
        miss: f64,
        tolerance: &[f64],
    ) -> Result<Option<Self>, MonitorError> {
        let mut factor = 1;
        while blocks.len() / factor >= LEAST_BLOCKS {
            let rows = blocks.rows * factor;
            let mut features = Vec::with_capacity(components);
            let level = 1.0 - miss / (2 * components) as f64;
            for component in 0..components {
                let own: Vec<[f64; 2]> = blocks
                    .merged(component, factor)
                    .filter_map(|sums| sums.features(rows))
                    .collect();
                features.push(feature_pair(&own, rows, level, tolerance[component])?);
            }
            let found = features.iter().flatten().flatten();
            let longest = found.map(|feature| feature.correlation.abs());
            let most = longest.fold(0.0, f64::max);
            let count = blocks.len() / factor;
            let is_judged = features.iter().any(Option::is_some);
            if is_judged && most + 1.0 / (count as f64).sqrt() <= MOST_CORRELATION {
                return Ok(Some(Self {
                    block_rows: rows,
                    blocks: count,
                    features,
                }));
            }
            factor *= 2;
        }
        Ok(None)
    }
}

/// Both features of a component; none with too few blocks.
fn feature_pair(
    own: &[[f64; 2]],
    rows: usize,
    level: f64,
    tolerance: f64,
) -> Result<Option<[Feature; 2]>, MonitorError> {
    if own.len() < LEAST_BLOCKS {
        return Ok(None);
    }
    let least = LEAST_SHARE / (rows as f64).sqrt();
    let column = |which: usize| own.iter().map(|pair| pair[which]).collect::<Vec<f64>>();
    let means = feature(&column(0), least, level, tolerance)?;
    let mut sizes = feature(&column(1), least, level, 0.0)?;
    // a mean that is off by the tolerance makes the mean square larger by this
    let grown = tolerance * (tolerance + 2.0 * means.mean.abs());
    sizes.margin += ((sizes.mean.powi(3) + grown).cbrt() - sizes.mean) / sizes.sd;
    Ok(Some([means, sizes]))
}

fn feature(
    values: &[f64],
    least: f64,
    level: f64,
    tolerance: f64,
) -> Result<Feature, MonitorError> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let about = |lag: usize| {
        let pairs = values.iter().zip(&values[lag..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>()
    };
    let (square, product) = (about(0), about(1));
    let correlation = match square > 0.0 {
        true => product / square,
        false => 0.0,
    };
    let plain = (square / (count - 1.0)).sqrt();
    // what successive blocks share adds to the variance of long means; its estimate is off by 1 / sqrt(count)
    let memory = 1.0 + 2.0 * (correlation + 1.0 / count.sqrt()).max(0.0);
    let sd = (plain * memory.sqrt()).max(least);
    let low = chi_square_quantile(0.5 * (1.0 - level), count - 1.0)?;
    Ok(Feature {
        mean,
        sd,
        correlation,
        margin: student_t_quantile(level, count - 1.0)? / count.sqrt() + tolerance / sd,
        widened: (low / (count - 1.0)).sqrt().recip(),
    })
}
