//! Shares with Wilson's interval.

use serde::Serialize;

const LEVEL: f64 = 0.95;

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
    /// `count` of `of`.
    pub fn new(count: u64, of: u64) -> Self {
        let interval = haptical_metrics::wilson_interval(count as usize, of as usize, LEVEL);
        match interval {
            Ok(interval) => Self {
                count,
                of,
                share: Some(count as f64 / of as f64),
                ci95: Some([interval.low, interval.high]),
            },
            Err(_) => Self::default(),
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
