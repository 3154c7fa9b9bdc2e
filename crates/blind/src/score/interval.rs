//! Shares with Wilson's interval.

use serde::Serialize;

/// Quantile of the normal distribution for 95 % on both sides.
const QUANTILE: f64 = 1.959_963_984_540_054;

/// A share of trials, with Wilson's 95 % score interval.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Rate {
    /// How many.
    pub count: u64,
    /// Of how many.
    pub of: u64,
    /// Share; absent where there is nothing to count.
    pub share: Option<f64>,
    /// 95 % interval of the share.
    pub ci95: Option<[f64; 2]>,
}

impl Rate {
    /// `count` of `of`. Source: Wilson, "Probable inference, the law of succession, and statistical
    /// inference", JASA 22, 1927:
    /// `(p + z^2/2n +- z sqrt(p (1-p)/n + z^2/4n^2)) / (1 + z^2/n)`.
    pub fn new(count: u64, of: u64) -> Self {
        if of == 0 {
            return Self::default();
        }
        let (n, z2) = (of as f64, QUANTILE * QUANTILE);
        let share = count as f64 / n;
        let centre = share + z2 / (2.0 * n);
        let half = QUANTILE * libm::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
        let scale = 1.0 + z2 / n;
        Self {
            count,
            of,
            share: Some(share),
            ci95: Some([
                ((centre - half) / scale).max(0.0),
                ((centre + half) / scale).min(1.0),
            ]),
        }
    }

    /// How many of `cases` are true.
    pub fn of_cases(cases: impl IntoIterator<Item = bool>) -> Self {
        let (mut count, mut of) = (0, 0);
        for case in cases {
            count += u64::from(case);
            of += 1;
        }
        Self::new(count, of)
    }
}
