//! Bootstrap intervals of any statistic, for independent samples and for time series.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::error::{MetricsError, check_count, check_level, check_range};
use crate::quantile::{Interval, percentile_interval};

/// Smallest share of the resamples in which the statistic must have a value.
const DEFINED_SHARE: f64 = 0.5;

/// Settings of a bootstrap: how many resamples, from which seed, for which interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bootstrap {
    /// Number of resamples; at least `2 / (1 - level)`, so that each tail holds one of them.
    pub replicates: usize,
    /// Seed of the ChaCha8 generator; the same seed gives the same interval on every machine.
    pub seed: u64,
    /// Confidence level, between 0 and 1.
    pub level: f64,
    /// 1 draws single samples; more draws blocks of successive samples, for correlated errors.
    pub block_length: usize,
}

impl Bootstrap {
    /// Percentile interval of a statistic over resamples of the indices `0 .. sample_size`.
    ///
    /// Each resample is a list of `sample_size` indices drawn with replacement: one by one when
    /// `block_length` is 1, otherwise in blocks that start anywhere and wrap from the last sample
    /// to the first. `statistic` receives the list and returns a value, or `None` where it is not
    /// defined; such resamples are left out. The ends are the type 7 quantiles at
    /// `(1 -+ level) / 2`, in the unit of the statistic. Sources: Efron & Tibshirani, An
    /// Introduction to the Bootstrap, 1993, chapter 13; Politis & Romano, A circular
    /// block-resampling procedure for stationary data, 1992.
    ///
    /// # Errors
    /// [`MetricsError::TooFew`] for fewer than two samples or too few replicates,
    /// [`MetricsError::OutOfRange`] for a level or block length that is not allowed,
    /// [`MetricsError::NonFinite`] when the statistic returns NaN or infinity (`index` is then the
    /// number of the resample), [`MetricsError::StatisticUndefined`] when it returns `None` in more
    /// than half of the resamples.
    ///
    /// # Examples
    /// ```
    /// use haptical_metrics::Bootstrap;
    /// let errors_mm = [1.2, 0.8, 1.1, 0.9, 1.4, 0.7, 1.0, 1.3];
    /// let bootstrap = Bootstrap { replicates: 1000, seed: 1, level: 0.95, block_length: 1 };
    /// let mean = |rows: &[usize]| {
    ///     Some(rows.iter().map(|&row| errors_mm[row]).sum::<f64>() / rows.len() as f64)
    /// };
    /// let interval = bootstrap.interval(errors_mm.len(), mean)?;
    /// assert!(interval.contains(1.05) && interval.width() < 0.5);
    /// # Ok::<(), haptical_metrics::MetricsError>(())
    /// ```
    pub fn interval(
        &self,
        sample_size: usize,
        statistic: impl FnMut(&[usize]) -> Option<f64>,
    ) -> Result<Interval, MetricsError> {
        let values = self.replicate(sample_size, statistic)?;
        percentile_interval(&values, self.level)
    }

    /// Values of the statistic over all resamples in which it is defined.
    fn replicate(
        &self,
        sample_size: usize,
        mut statistic: impl FnMut(&[usize]) -> Option<f64>,
    ) -> Result<Vec<f64>, MetricsError> {
        self.check(sample_size)?;
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        let mut rows = Vec::with_capacity(sample_size + self.block_length);
        let mut values = Vec::with_capacity(self.replicates);
        for index in 0..self.replicates {
            rows.clear();
            while rows.len() < sample_size {
                let start = generator.random_range(0..sample_size);
                rows.extend((start..start + self.block_length).map(|row| row % sample_size));
            }
            rows.truncate(sample_size);
            if let Some(value) = statistic(&rows) {
                if !value.is_finite() {
                    let what = "the statistic of a resample";
                    return Err(MetricsError::NonFinite { what, index, value });
                }
                values.push(value);
            }
        }
        let needed = (self.replicates as f64 * DEFINED_SHARE).ceil() as usize;
        if values.len() < needed {
            let (defined, replicates) = (values.len(), self.replicates);
            return Err(MetricsError::StatisticUndefined {
                defined,
                replicates,
                needed,
            });
        }
        Ok(values)
    }

    fn check(&self, sample_size: usize) -> Result<(), MetricsError> {
        check_level(self.level)?;
        check_count("the sample", sample_size, 2)?;
        let is_within = (1..=sample_size).contains(&self.block_length);
        let allowed = "from 1 to the sample size";
        check_range("block_length", self.block_length as f64, is_within, allowed)?;
        // The small allowance keeps 40 replicates at level 0.95 on the allowed side of rounding.
        let needed = (2.0 / (1.0 - self.level) - 1e-6).ceil() as usize;
        check_count("the bootstrap (replicates)", self.replicates, needed)
    }
}
