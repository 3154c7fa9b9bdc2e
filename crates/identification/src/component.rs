//! Parts of a covariance, each with the degrees of freedom of its level of noise.

use haptical_linalg::Matrix;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A part of a covariance that is in proportion to one estimated level of noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Covariance of the parameters.
    pub covariance: Matrix,
    /// Degrees of freedom of the level.
    pub degrees_of_freedom: f64,
}

impl Component {
    /// The same with a covariance that is so many times as large.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for column in 0..self.covariance.columns() {
            let entries = self.covariance.column_mut(column).iter_mut();
            entries.for_each(|entry| *entry *= factor);
        }
        self
    }

    /// The same among `count` parameters, its own from `first` on.
    #[must_use]
    pub fn placed(&self, first: usize, count: usize) -> Self {
        let own = self.covariance.columns();
        let entry = |a: usize, b: usize| match (a.checked_sub(first), b.checked_sub(first)) {
            (Some(a), Some(b)) if a < own && b < own => self.covariance[(a, b)],
            _ => 0.0,
        };
        Self {
            covariance: Matrix::from_fn(count, count, entry),
            ..*self
        }
    }
}

/// Variance of a linear function of the parameters and its degrees of freedom (Satterthwaite 1946): `part` gives its
/// variance by the covariance of one component.
#[must_use]
pub fn pooled(components: &[Component], part: &dyn Fn(&Matrix) -> f64) -> (f64, f64) {
    let (mut variance, mut scatter) = (0.0, 0.0);
    for component in components {
        let own = part(&component.covariance);
        variance += own;
        scatter += own * own / component.degrees_of_freedom;
    }
    let freedom = if scatter > 0.0 {
        variance * variance / scatter
    } else {
        f64::INFINITY
    };
    (variance, freedom)
}

/// Half width of the 95 % interval in standard deviations, Student's t.
pub(crate) fn quantile(freedom: f64) -> f64 {
    const NORMAL_95: f64 = 1.959_963_984_540_054;
    // the expansion in 1 / freedom (Abramowitz & Stegun 26.7.5): the search for the inverse is inexact there, or never ends
    const EXPANDED_FROM: f64 = 1e3;
    if freedom < EXPANDED_FROM
        && let Ok(spread) = StudentsT::new(0.0, 1.0, freedom)
    {
        return spread.inverse_cdf(0.975);
    }
    let z = NORMAL_95;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + (first + (second + third / freedom) / freedom) / freedom
}

#[cfg(test)]
mod tests {
    use super::quantile;

    /// Values of scipy.stats.t.ppf(0.975, freedom).
    #[test]
    fn quantiles_of_any_freedom_are_those_of_tables() {
        let table = [
            (0.5, 164.557_673_480_488),
            (1.0, 12.706_204_736_174_7),
            (2.37, 3.718_920_839_797),
            (30.0, 2.042_272_456_301_24),
            (999.5, 1.962_340_270_384),
            (1000.5, 1.962_337_892_459),
            (99_999.5, 1.959_987_707_653),
            (100_000.5, 1.959_987_707_416),
            (1e12, 1.959_963_984_542),
        ];
        for (freedom, expected) in table {
            let found = quantile(freedom);
            assert!((found / expected - 1.0).abs() < 1e-9, "{freedom}: {found}");
        }
        let mut before = f64::INFINITY;
        for step in 0..4000 {
            let found = quantile(0.5 * 1.005_f64.powi(step));
            assert!(
                found <= before * (1.0 + 1e-9),
                "{step}: {found} after {before}"
            );
            before = found;
        }
        assert_eq!(quantile(f64::INFINITY), 1.959_963_984_540_054);
    }
}
