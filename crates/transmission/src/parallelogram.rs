//! The error of a parallelogram whose four bars have wrong lengths, eq. (2) corrected.
//!
//! Short derivation (docs/equations.md, Parallelogram error). The loop is A-B-C-E with `AB = L1`,
//! `BC = L2`, `CE = L3`, `EA = L4`. The input sets the interior angle at B to `pi/2 - theta_a`; the
//! output is the interior angle at A. The diagonal `s = AC` cuts the loop into two triangles:
//!
//! ```text
//! s^2   = L1^2 + L2^2 - 2 L1 L2 cos(pi/2 - theta_a)
//! alpha = angle BAC = acos[(L1^2 + s^2 - L2^2) / (2 L1 s)]
//! gamma = angle CAE = acos[(L4^2 + s^2 - L3^2) / (2 L4 s)]
//! error = (alpha + gamma - pi/2 - theta_a) - (the same at theta_a = 0)
//! ```
//!
//! A parallelogram has `alpha + gamma = pi/2 + theta_a`. The paper's print lacks both `acos` and has
//! `s` for `s^2`. Both angles are computed here with `atan2`, whose argument cannot leave its domain by
//! rounding and which loses fewer digits than `acos` where the cosine is near 1: with `u = L1 - L2 sin theta_a`, `v = L2 cos theta_a` it is `s^2 = u^2 + v^2`,
//! `alpha = atan2(v, u)`, and `gamma = atan2(k, L4^2 + s^2 - L3^2)`, where `k = 2 L4 s sin gamma` is
//! four times the area of the triangle CAE by Heron's product.

use crate::error::{LawError, finite, positive};
use crate::evaluation::Evaluation;
use crate::four_bar::{FourBar, SINGULAR_MARGIN};
use core::f64::consts::FRAC_PI_2;

const LENGTH_NAMES: [&str; 4] = ["length 1, m", "length 2, m", "length 3, m", "length 4, m"];

/// A four-bar loop A-B-C-E by its nominal lengths AB, BC, CE, EA.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    lengths_m: [f64; 4],
}

impl Parallelogram {
    /// A loop with nominal lengths AB, BC, CE, EA in m. The lengths need not form a parallelogram, but
    /// must form a loop at home.
    ///
    /// Source: Baser & Konukseven eq. (2); docs/equations.md, Parallelogram error.
    ///
    /// # Errors
    /// [`LawError::NonFinite`], [`LawError::OutOfRange`] for a length that is not
    /// positive, [`LawError::OpenLoop`] or [`LawError::SingularLoop`] at home.
    pub fn new(lengths_m: [f64; 4]) -> Result<Self, LawError> {
        for (length_m, name) in lengths_m.into_iter().zip(LENGTH_NAMES) {
            positive(name, length_m)?;
        }
        interior_angle(lengths_m, 0.0)?;
        Ok(Self { lengths_m })
    }

    /// Nominal lengths AB, BC, CE, EA, m.
    #[must_use]
    pub const fn lengths_m(&self) -> [f64; 4] {
        self.lengths_m
    }

    /// Error at the input angle `theta_a_rad` in rad; the value of [`Self::evaluate`].
    ///
    /// Source: Baser & Konukseven eq. (2), corrected; docs/equations.md, Parallelogram error.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    ///
    /// ```
    /// use haptical_transmission::Parallelogram;
    /// let elbow = Parallelogram::new([0.18, 0.076, 0.18, 0.076])?;
    /// assert!(elbow.error(&[0.0; 4], 0.6)?.abs() < 1e-15);
    /// // a crank BC that is 0.7 mm short: dL2 tan(theta) / L4 to first order
    /// let error_rad = elbow.error(&[0.0, -0.0007, 0.0, 0.0], 0.6)?;
    /// assert!((error_rad - -0.0007 * 0.6f64.tan() / 0.076).abs() < 1e-4);
    /// # Ok::<(), haptical_transmission::LawError>(())
    /// ```
    pub fn error(&self, deviations_m: &[f64; 4], theta_a_rad: f64) -> Result<f64, LawError> {
        Ok(self.evaluate(deviations_m, theta_a_rad)?.value_rad)
    }

    /// Error of the loop with lengths `L_i + dL_i` at the input angle `theta_a_rad`, less its value at
    /// home, with its slope and its derivatives with respect to the four deviations:
    ///
    /// `error = alpha(theta_a) + gamma(theta_a) - theta_a - alpha(0) - gamma(0)`.
    ///
    /// To first order about a parallelogram it is
    /// `[(dL3 - dL1) (1 / cos theta_a - 1) + (dL2 - dL4) tan theta_a] / L4`.
    /// `deviations_m` in m in the order AB, BC, CE, EA; results in rad, rad/rad and rad/m.
    ///
    /// Source: Baser & Konukseven eq. (2), corrected; docs/equations.md, Parallelogram error.
    ///
    /// # Errors
    /// [`LawError::NonFinite`], [`LawError::OutOfRange`] for a length that is not
    /// positive, [`LawError::OpenLoop`] where the bars do not close,
    /// [`LawError::SingularLoop`] where a triangle is a line, or for `|theta_a| >= pi/2`.
    pub fn evaluate(
        &self,
        deviations_m: &[f64; 4],
        theta_a_rad: f64,
    ) -> Result<Evaluation<4>, LawError> {
        let mut lengths_m = self.lengths_m;
        for ((length_m, deviation_m), name) in
            lengths_m.iter_mut().zip(deviations_m).zip(LENGTH_NAMES)
        {
            *length_m = positive(name, *length_m + deviation_m)?;
        }
        finite("parallelogram input angle, rad", theta_a_rad)?;

        let here = interior_angle(lengths_m, theta_a_rad)?;
        let home = interior_angle(lengths_m, 0.0)?;
        let mut derivatives = here.derivatives;
        for (derivative, at_home) in derivatives.iter_mut().zip(home.derivatives) {
            *derivative -= at_home;
        }
        Evaluation {
            value_rad: (here.value_rad - home.value_rad) - theta_a_rad,
            slope: here.slope - 1.0,
            derivatives,
        }
        .checked()
    }
}

/// The interior angle at A, `alpha + gamma`, its slope and its derivatives with respect to the lengths.
fn interior_angle(lengths_m: [f64; 4], theta_a_rad: f64) -> Result<Evaluation<4>, LawError> {
    let (bars, scale_m) = FourBar::new(lengths_m);
    let singular = LawError::SingularLoop {
        lengths_m,
        theta_a_rad,
    };
    let (sin, cos) = libm::sincos(theta_a_rad);
    if theta_a_rad.abs() >= FRAC_PI_2 || cos <= SINGULAR_MARGIN {
        return Err(singular);
    }
    let corner = bars.corner((sin, cos));
    let [u, v] = corner;
    let s = libm::hypot(u, v);
    let [perimeter, excesses @ ..] = bars.heron(s);
    let smallest = excesses.into_iter().fold(f64::INFINITY, f64::min);
    if smallest < 0.0 {
        return Err(LawError::OpenLoop {
            lengths_m,
            theta_a_rad,
        });
    }
    if smallest <= SINGULAR_MARGIN * perimeter {
        return Err(singular);
    }
    let k = libm::sqrt(perimeter * excesses[0]) * libm::sqrt(excesses[1] * excesses[2]);
    let gamma = libm::atan2(k, bars.gamma_side(s));

    let [_, l2, l3, l4] = bars.lengths();
    let through_diagonal = |rates| bars.rate(corner, rates, [s, k]);
    Evaluation {
        value_rad: libm::atan2(v, u) + gamma,
        slope: through_diagonal([-v, -l2 * sin]),
        derivatives: [
            through_diagonal([1.0, 0.0]),
            through_diagonal([-sin, cos]),
            2.0 * l3 / k,
            (s * s - l3 * l3 - l4 * l4) / (l4 * k),
        ]
        .map(|derivative| derivative / scale_m),
    }
    .checked()
}
