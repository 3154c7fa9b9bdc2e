//! What is known of an input quantity: its distribution, and how well its size is known.

use rand::{Rng, RngExt};
use statrs::distribution::{ContinuousCDF, Normal};

/// Distribution of an input about its estimate (JCGM 100, 4.3; JCGM 101, 6.4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Normal, as of a certificate: expanded uncertainty over its coverage factor.
    Normal {
        /// Standard uncertainty.
        standard_uncertainty: f64,
    },
    /// Equally likely within plus and minus a half width: a limit, the step of a display.
    Rectangular {
        /// Half width.
        half_width: f64,
    },
    /// The sum of two equal rectangular ones.
    Triangular {
        /// Half width.
        half_width: f64,
    },
    /// U-shaped: what a cyclic change leaves at a random moment.
    Arcsine {
        /// Half width.
        half_width: f64,
    },
}

/// An input quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// How it is distributed about its estimate.
    pub distribution: Distribution,
    /// Degrees of freedom of its standard uncertainty; infinite where that is known.
    pub degrees_of_freedom: f64,
}

/// Degrees of freedom of a standard uncertainty that is known to a relative part: `1 / (2 r^2)` (JCGM 100, eq. (G.3)).
///
/// ```
/// // JCGM 100, H.1.6: known to 10 % and to 50 %
/// let degrees = haptical_metrics::budget::degrees_of_reliability;
/// assert!((degrees(0.1) - 50.0).abs() < 1e-12 && (degrees(0.5) - 2.0).abs() < 1e-12);
/// ```
pub fn degrees_of_reliability(relative: f64) -> f64 {
    0.5 / (relative * relative)
}

impl Input {
    /// An input.
    pub fn new(distribution: Distribution, degrees_of_freedom: f64) -> Self {
        Self {
            distribution,
            degrees_of_freedom,
        }
    }

    /// Standard deviation of the distribution.
    pub fn standard_uncertainty(&self) -> f64 {
        match self.distribution {
            Distribution::Normal {
                standard_uncertainty,
            } => standard_uncertainty,
            Distribution::Rectangular { half_width } => half_width / 3.0_f64.sqrt(),
            Distribution::Triangular { half_width } => half_width / 6.0_f64.sqrt(),
            Distribution::Arcsine { half_width } => half_width / 2.0_f64.sqrt(),
        }
    }

    /// A draw, about 0. A normal one of finitely many degrees of freedom is Student's, scaled (JCGM 101, 6.4.9).
    pub(super) fn draw(&self, rng: &mut impl Rng, normal: &Normal) -> f64 {
        match self.distribution {
            Distribution::Normal {
                standard_uncertainty,
            } => standard_uncertainty * student(self.degrees_of_freedom, rng, normal),
            Distribution::Rectangular { half_width } => half_width * (2.0 * uniform(rng) - 1.0),
            Distribution::Triangular { half_width } => {
                half_width * (uniform(rng) + uniform(rng) - 1.0)
            }
            Distribution::Arcsine { half_width } => {
                half_width * (2.0 * std::f64::consts::PI * uniform(rng)).cos()
            }
        }
    }
}

/// Between 0 and 1, both excluded.
fn uniform(rng: &mut impl Rng) -> f64 {
    // the middle of one of 2^53 parts
    ((rng.random::<u64>() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// A standard normal draw.
pub(super) fn standard_normal(rng: &mut impl Rng, normal: &Normal) -> f64 {
    normal.inverse_cdf(uniform(rng))
}

/// A draw of Student's distribution; of infinitely many degrees of freedom the normal one.
pub(super) fn student(degrees: f64, rng: &mut impl Rng, normal: &Normal) -> f64 {
    standard_normal(rng, normal) * student_factor(degrees, rng, normal)
}

/// What turns normal draws into those of Student's distribution, several at once into those of the joint one: the root of the degrees
/// of freedom over a draw of chi-square, by Marsaglia & Tsang 2000, *ACM Transactions on Mathematical Software* 26.
pub(super) fn student_factor(degrees: f64, rng: &mut impl Rng, normal: &Normal) -> f64 {
    if degrees >= 1e6 {
        return 1.0;
    }
    let shape = 0.5 * degrees;
    // below 1 a draw of shape + 1 is made smaller by a power of a uniform one
    let (shape, smaller) = match shape < 1.0 {
        true => (shape + 1.0, uniform(rng).powf(1.0 / shape)),
        false => (shape, 1.0),
    };
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / (9.0 * d).sqrt();
    loop {
        let x = standard_normal(rng, normal);
        let v = (1.0 + c * x).powi(3);
        if v > 0.0 && uniform(rng).ln() < 0.5 * x * x + d - d * v + d * v.ln() {
            let chi_square = 2.0 * d * v * smaller;
            return (degrees / chi_square).sqrt();
        }
    }
}
