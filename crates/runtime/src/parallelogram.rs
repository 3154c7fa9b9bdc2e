//! The error of a capstan that drives a parallelogram, eq. (2) corrected.

use core::f64::consts::FRAC_PI_2;

use crate::Capstan;
use crate::capstan::PreparedCapstan;
use crate::error::{Refusal, length};
use crate::trigonometry::{arctangent2, constant_square_root, sine_cosine};

/// A capstan followed by a four-bar loop, as a device file holds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parallelogram {
    /// The drive at the motor.
    pub capstan: Capstan,
    /// Lengths AB, BC, CE, EA, identified deviations included \[m\].
    pub lengths_m: [f64; 4],
}

/// A triangle inequality must hold by this part of the perimeter, as in `haptical-transmission`.
const SINGULAR_MARGIN: f64 = 1e-9;

/// A cascade as a step needs it; lengths over the longest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedParallelogram {
    capstan: PreparedCapstan,
    l1: f64,
    l2: f64,
    l3: f64,
    l4: f64,
    /// Interior angle at A at home.
    home_rad: f64,
}

/// The loop at one input angle, before square roots: the caller's differ.
struct Corner {
    u: f64,
    v: f64,
    sine: f64,
    s_squared: f64,
}

impl PreparedParallelogram {
    pub(crate) const fn new(parallelogram: &Parallelogram) -> Result<Self, Refusal> {
        let capstan = match PreparedCapstan::new(&parallelogram.capstan) {
            Ok(capstan) => capstan,
            Err(refusal) => return Err(refusal),
        };
        let lengths_m = parallelogram.lengths_m;
        let mut longest_m = 0.0;
        let mut index = 0;
        while index < lengths_m.len() {
            match length("parallelogram_lengths_m", lengths_m[index]) {
                Ok(length_m) if length_m > longest_m => longest_m = length_m,
                Ok(_) => {}
                Err(refusal) => return Err(refusal),
            }
            index += 1;
        }
        let [l1, l2, l3, l4] = lengths_m;
        let mut prepared = Self {
            capstan,
            l1: l1 / longest_m,
            l2: l2 / longest_m,
            l3: l3 / longest_m,
            l4: l4 / longest_m,
            home_rad: 0.0,
        };
        let corner = prepared.corner((0.0, 1.0));
        let s = constant_square_root(corner.s_squared);
        prepared.home_rad = match prepared.heron(s) {
            Some(product) => prepared.interior_angle(&corner, constant_square_root(product)),
            None => {
                return Err(Refusal {
                    quantity: "parallelogram_lengths_m",
                    value: lengths_m[0],
                    allowed: "four lengths that form a loop at home",
                });
            }
        };
        Ok(prepared)
    }

    pub(crate) const fn largest_reading(&self) -> f64 {
        self.capstan.largest_reading()
    }

    #[inline]
    const fn corner(&self, (sine, cosine): (f64, f64)) -> Corner {
        let (u, v) = (self.l1 - self.l2 * sine, self.l2 * cosine);
        Corner {
            u,
            v,
            sine,
            s_squared: u * u + v * v,
        }
    }

    /// Heron's product `k^2`, or nothing where the triangle CAE is open or a line.
    #[inline]
    const fn heron(&self, s: f64) -> Option<f64> {
        let (l3, l4) = (self.l3, self.l4);
        let perimeter = l3 + l4 + s;
        let (first, second, third) = (l3 + l4 - s, l3 + (s - l4), l4 + (s - l3));
        let margin = SINGULAR_MARGIN * perimeter;
        if first > margin && second > margin && third > margin {
            Some(perimeter * first * (second * third))
        } else {
            None
        }
    }

    /// `l4^2 - l3^2` without loss of digits.
    #[inline]
    const fn difference(&self) -> f64 {
        (self.l4 - self.l3) * (self.l4 + self.l3)
    }

    /// Interior angle at A, `alpha + gamma`: docs/equations.md, Parallelogram error.
    #[inline]
    const fn interior_angle(&self, corner: &Corner, k: f64) -> f64 {
        arctangent2(corner.v, corner.u) + arctangent2(k, corner.s_squared + self.difference())
    }

    /// Error and slope at a reading, or nothing where the loop is open or a line.
    ///
    /// Source: Baser & Konukseven eq. (1) and (2); docs/equations.md, Parallelogram error.
    #[inline]
    pub(crate) fn error(&self, reading: f64) -> Option<(f64, f64)> {
        let (capstan, capstan_slope) = self.capstan.error(reading);
        let input_rad = reading + capstan;
        let (sine, cosine) = sine_cosine(input_rad);
        if input_rad.abs() >= FRAC_PI_2 || cosine <= SINGULAR_MARGIN {
            return None;
        }
        let corner = self.corner((sine, cosine));
        let k = libm::sqrt(self.heron(libm::sqrt(corner.s_squared))?);
        let angle_rad = self.interior_angle(&corner, k) - self.home_rad - input_rad;

        // du/dtheta = -v, dv/dtheta = -l2 sin; gamma's rate with s is (l4^2 - l3^2 - s^2) / (s k)
        let v_rate = -self.l2 * corner.sine;
        let alpha_rate = (corner.u * v_rate + corner.v * corner.v) / corner.s_squared;
        let half_square_rate = corner.v * (v_rate - corner.u);
        let gamma_rate =
            (self.difference() - corner.s_squared) * half_square_rate / (corner.s_squared * k);
        let slope = alpha_rate + gamma_rate - 1.0;
        Some((
            capstan + angle_rad,
            capstan_slope + slope * (1.0 + capstan_slope),
        ))
    }
}
