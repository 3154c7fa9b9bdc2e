//! What one model leaves less than another on parts of rows that neither fit saw.

use haptical_linalg::{jackknife_sd, sum_sd};

/// A gain over some parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Over all parts, in squares over the variance of noise.
    pub sum: f64,
    /// Standard deviation of the sum, by what the parts differ by.
    pub sd: f64,
    /// Number of parts.
    pub parts: usize,
    /// Number of parts that gain.
    pub gaining: usize,
    /// Sum of the ranks, by size from 1, of the parts that do not gain (Wilcoxon 1945).
    pub ranks_against: f64,
}

impl Gain {
    /// Of what each part gains.
    ///
    /// ```
    /// let gain = haptical_judge::Gain::new(&[5.0, -1.0, 8.0]);
    /// assert_eq!((gain.sum, gain.gaining, gain.ranks_against), (12.0, 2, 1.0));
    /// ```
    pub fn new(gains: &[f64]) -> Self {
        let mut sorted = gains.to_vec();
        sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let ranks = sorted.iter().zip(1_u32..);
        let against = ranks.filter(|(gain, _)| **gain <= 0.0);
        Self {
            sum: gains.iter().sum(),
            sd: sum_sd(gains),
            parts: gains.len(),
            gaining: gains.iter().filter(|gain| **gain > 0.0).count(),
            ranks_against: against.map(|(_, rank)| f64::from(rank)).sum(),
        }
    }

    /// Of the squares that two models leave of each part.
    pub fn between(before: &[f64], after: &[f64]) -> Self {
        let pairs = before.iter().zip(after);
        Self::new(
            &pairs
                .map(|(before, after)| before - after)
                .collect::<Vec<_>>(),
        )
    }

    /// The sum in its standard deviations.
    pub fn deviations(self) -> f64 {
        self.sum / self.sd.max(f64::MIN_POSITIVE)
    }

    /// The same, or by how many parts gain at all (the sign test) where that is surer: a few parts that a fit extrapolates to badly
    /// scatter the sizes.
    pub fn deviations_by_sign(self) -> f64 {
        let count = self.parts as f64;
        let by_sign = (2.0 * self.gaining as f64 - count) / count.sqrt();
        match self.sum > 0.0 {
            true => self.deviations().max(by_sign),
            false => self.deviations(),
        }
    }

    /// Share of the parts that gain.
    pub fn share_gaining(self) -> f64 {
        self.gaining as f64 / self.parts.max(2) as f64
    }
}

/// A share of the squares beyond noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closed {
    /// Below zero where more is left than before.
    pub share: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
}

/// Share of the squares beyond noise that a model closes on unseen parts, with its interval by the parts (jackknife). `noise`: squares of
/// all parts together by noise alone.
///
/// ```
/// use haptical_judge::closed_share;
///
/// let closed = closed_share(&[10.0; 4], &[2.0; 4], 4.0);
/// assert!((closed.share - 8.0 / 9.0).abs() < 1e-12);
/// // what is left is noise: all is closed
/// assert_eq!(closed_share(&[10.0; 4], &[0.5; 4], 4.0).share, 1.0);
/// ```
pub fn closed_share(before: &[f64], after: &[f64], noise: f64) -> Closed {
    let parts = before.len();
    let share = |without: Option<usize>| {
        let sum = |values: &[f64]| -> f64 {
            let kept = values.iter().enumerate();
            let kept = kept.filter(|(part, _)| Some(*part) != without);
            kept.map(|(_, value)| value).sum()
        };
        let noise = match without {
            Some(_) => noise * (1.0 - 1.0 / parts as f64),
            None => noise,
        };
        let gap = (sum(before) - noise).max(1e-300);
        1.0 - (sum(after) - noise).max(0.0) / gap
    };
    let whole = share(None);
    let sd = jackknife_sd((0..parts).map(|part| share(Some(part))));
    Closed {
        share: whole,
        ci95: [whole - 1.96 * sd, (whole + 1.96 * sd).min(1.0)],
    }
}
