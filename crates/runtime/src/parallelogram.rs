//! The error of a capstan that drives a parallelogram, eq. (2) corrected.

use core::f64::consts::FRAC_PI_2;

use haptical_kinematics::trigonometry::{arctangent2, constant_square_root, sine_cosine};
use haptical_transmission::FourBar;

use crate::Capstan;
use crate::capstan::PreparedCapstan;
use crate::error::{Refusal, attempt, length};

/// A capstan followed by a four-bar loop, as a device file holds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parallelogram {
    /// The drive at the motor.
    pub capstan: Capstan,
    /// Lengths AB, BC, CE, EA, identified deviations included \[m\].
    pub lengths_m: [f64; 4],
}

/// A cascade as a step needs it: eq. (2) with sines and arctangents of fixed work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedParallelogram {
    capstan: PreparedCapstan,
    bars: FourBar,
    /// Interior angle at A at home.
    home_rad: f64,
}

impl PreparedParallelogram {
    pub(crate) const fn new(parallelogram: &Parallelogram) -> Result<Self, Refusal> {
        let capstan = attempt!(PreparedCapstan::new(&parallelogram.capstan));
        let lengths_m = parallelogram.lengths_m;
        let mut index = 0;
        while index < lengths_m.len() {
            attempt!(length("parallelogram_lengths_m", lengths_m[index]));
            index += 1;
        }
        let (bars, _) = FourBar::new(lengths_m);
        let [u, v] = bars.corner((0.0, 1.0));
        let s = constant_square_root(u * u + v * v);
        match closed(&bars, s) {
            Some([first, second]) => {
                let k = constant_square_root(first) * constant_square_root(second);
                Ok(Self {
                    capstan,
                    bars,
                    home_rad: arctangent2(v, u) + arctangent2(k, bars.gamma_side(s)),
                })
            }
            None => Err(Refusal {
                quantity: "parallelogram_lengths_m",
                value: lengths_m[0],
                allowed: "four lengths that form a loop at home",
            }),
        }
    }

    pub(crate) const fn largest_reading(&self) -> f64 {
        self.capstan.largest_reading()
    }

    /// Error and slope at a reading, or nothing where the loop is open or a line.
    ///
    /// Source: Baser & Konukseven eq. (1) and (2); docs/equations.md, Parallelogram error.
    #[inline]
    pub(crate) fn error(&self, reading: f64) -> Option<(f64, f64)> {
        let (capstan, capstan_slope) = self.capstan.error(reading);
        let input_rad = reading + capstan;
        let (sine, cosine) = sine_cosine(input_rad);
        if input_rad.abs() >= FRAC_PI_2 || cosine <= FourBar::SINGULAR_MARGIN {
            return None;
        }
        let [u, v] = self.bars.corner((sine, cosine));
        let s = libm::sqrt(u * u + v * v);
        let [first, second] = closed(&self.bars, s)?;
        let k = libm::sqrt(first) * libm::sqrt(second);
        let angle_rad = arctangent2(v, u) + arctangent2(k, self.bars.gamma_side(s));
        let [_, l2, _, _] = self.bars.lengths();
        let slope = self.bars.rate([u, v], [-v, -l2 * sine], [s, k]) - 1.0;
        Some((
            capstan + (angle_rad - self.home_rad - input_rad),
            capstan_slope + slope * (1.0 + capstan_slope),
        ))
    }
}

/// Heron's product in two factors, or nothing where the triangle CAE is open or a line.
#[inline]
const fn closed(bars: &FourBar, s: f64) -> Option<[f64; 2]> {
    let [perimeter, first, second, third] = bars.heron(s);
    let margin = FourBar::SINGULAR_MARGIN * perimeter;
    if first > margin && second > margin && third > margin {
        Some([perimeter * first, second * third])
    } else {
        None
    }
}
