//! Losses that forgive gross outliers: how much a residual of a given size weighs, and the size of the noise.

use serde::{Deserialize, Serialize};
use statrs::statistics::{Data, OrderStatistics};

use crate::IdentificationError;

/// What a residual costs, as a function of its size u in standard deviations of the good ones.
///
/// Minimising sum rho(u) is the same as least squares with the weights w(u) = rho'(u) / u, found in turns
/// with the fit (iteratively reweighted least squares; Huber & Ronchetti, *Robust Statistics*, 2009, section
/// 7.8). The tuning constants are those with 95 % efficiency under Gaussian noise, but for Student's t,
/// whose four degrees of freedom are the usual choice (Lange, Little & Taylor 1989).
///
/// ```
/// use haptical_identification::Loss;
/// assert_eq!(Loss::Squares.weight(50.0), 1.0);
/// assert_eq!(Loss::Huber.weight(13.45), 0.1);
/// assert_eq!(Loss::Tukey.weight(5.0), 0.0);
/// assert!(Loss::Cauchy.weight(5.0) < Loss::Huber.weight(5.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// u^2 / 2: least squares.
    Squares,
    /// Squares up to 1.345, linear beyond (Huber 1964). Convex: one minimum of a linear problem.
    Huber,
    /// c^2/2 log(1 + u^2/c^2), c = 2.385.
    Cauchy,
    /// Tukey's biweight: nothing beyond c = 4.685 weighs at all (Beaton & Tukey 1974).
    Tukey,
    /// The likelihood of Student's t with 4 degrees of freedom.
    StudentT,
}

const HUBER: f64 = 1.345;
const CAUCHY: f64 = 2.385;
const TUKEY: f64 = 4.685;
const DEGREES_OF_FREEDOM: f64 = 4.0;

/// One over the median of |u|, u standard normal: turns a median of sizes into a standard deviation.
const NORMAL_MEDIAN: f64 = 1.482_602_218_505_602;

impl Loss {
    /// w(u) = rho'(u) / u, 1 at u = 0, never above.
    pub fn weight(self, u: f64) -> f64 {
        let size = u.abs();
        match self {
            Self::Squares => 1.0,
            Self::Huber if size <= HUBER => 1.0,
            Self::Huber => HUBER / size,
            Self::Cauchy => 1.0 / (1.0 + (size / CAUCHY).powi(2)),
            Self::Tukey if size >= TUKEY => 0.0,
            Self::Tukey => (1.0 - (size / TUKEY).powi(2)).powi(2),
            Self::StudentT => DEGREES_OF_FREEDOM / (DEGREES_OF_FREEDOM + size * size),
        }
    }

    /// psi(u) = u w(u), with which a residual pulls.
    pub fn influence(self, u: f64) -> f64 {
        // a weight of a huge residual is 0 before their product could overflow
        u.clamp(-1e150, 1e150) * self.weight(u)
    }

    /// psi'(u).
    pub fn influence_slope(self, u: f64) -> f64 {
        let size = u.abs();
        match self {
            Self::Squares => 1.0,
            Self::Huber => f64::from(u8::from(size <= HUBER)),
            Self::Cauchy => {
                let ratio = (size / CAUCHY).powi(2);
                (1.0 - ratio) / (1.0 + ratio) / (1.0 + ratio)
            }
            Self::Tukey if size >= TUKEY => 0.0,
            Self::Tukey => {
                let ratio = (size / TUKEY).powi(2);
                (1.0 - ratio) * (1.0 - 5.0 * ratio)
            }
            Self::StudentT => {
                let ratio = size * size / DEGREES_OF_FREEDOM;
                (1.0 - ratio) / (1.0 + ratio) / (1.0 + ratio)
            }
        }
    }

    /// Whether large residuals pull less than middling ones. Such a loss has minima of its own around
    /// outliers, so its fit begins with Huber's.
    pub fn is_redescending(self) -> bool {
        matches!(self, Self::Cauchy | Self::Tukey | Self::StudentT)
    }

    /// Variance of a robust estimate over that which weighted least squares would state, the noise of the
    /// weighted rows being 1: mean(w) mean(psi^2) / mean(psi')^2 (Huber & Ronchetti 2009, eq. (7.81), with
    /// the covariance (J^T W J)^-1 in place of (J^T J)^-1 / mean(w)). `sizes` are the u of all rows.
    ///
    /// # Errors
    /// [`IdentificationError::NothingFree`] if no row is left that the loss counts.
    pub fn variance_factor(self, sizes: &[f64]) -> Result<f64, IdentificationError> {
        let count = sizes.len() as f64;
        let mean = |of: &dyn Fn(f64) -> f64| sizes.iter().map(|&u| of(u)).sum::<f64>() / count;
        let slope = mean(&|u| self.influence_slope(u));
        let factor =
            mean(&|u| self.weight(u)) * mean(&|u| self.influence(u).powi(2)) / (slope * slope);
        if slope > 0.0 && factor.is_finite() {
            Ok(factor)
        } else {
            Err(IdentificationError::NothingFree)
        }
    }
}

impl std::fmt::Display for Loss {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(match self {
            Self::Squares => "squares",
            Self::Huber => "huber",
            Self::Cauchy => "cauchy",
            Self::Tukey => "tukey",
            Self::StudentT => "student-t",
        })
    }
}

/// Standard deviation of residuals from the median of their sizes (MAD about zero), as if normal, which half
/// of them may belie; `parameters` were fitted to them. 0 for no residuals.
///
/// ```
/// use haptical_identification::robust_scale;
/// let scale = robust_scale(&[-0.6745, 0.3, 0.6745, -0.5, 0.8, 1e9, -0.9], 0.0);
/// assert!((scale - 1.0).abs() < 1e-4);
/// ```
pub fn robust_scale(residuals: &[f64], parameters: f64) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let count = sizes.len() as f64;
    let median = Data::new(&mut sizes[..]).median();
    NORMAL_MEDIAN * median * (count / (count - parameters).max(1.0)).sqrt()
}
