//! The error of a capstan drive, eq. (1), with what does not change worked out beforehand.

use crate::error::{Refusal, bounded, is_bounded, length};
use crate::trigonometry::{sine_cosine, small_arctangent};

/// A capstan drive and its identified error, as a device file holds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capstan {
    /// Nominal ratio, motor over joint.
    pub transmission_ratio: f64,
    /// Distance of the drums' axes \[m\].
    pub drum_distance_m: f64,
    /// Denominator of the input drum's term \[m\].
    pub input_drum_denominator_m: f64,
    /// Offset at home \[rad\], or \[m\] for a prismatic joint.
    pub offset: f64,
    /// Deviation of the ratio.
    pub ratio_deviation: f64,
    /// Centre of the output drum from its axis at home \[m\].
    pub output_drum_xy_m: [f64; 2],
    /// Centre of the input drum from its axis at home \[m\].
    pub input_drum_xy_m: [f64; 2],
}

/// Part of its denominator that an eccentricity may reach: a hundred times what drums have. With it
/// the tangent `n / d` is at most 0.3 / 0.7, within the range of [`small_arctangent`].
const LARGEST_ECCENTRICITY: f64 = 0.3;

/// An eccentric drum: its centre at home over the denominator, and its angle there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Drum {
    x: f64,
    y: f64,
    home_rad: f64,
}

impl Drum {
    const fn new(
        quantity: &'static str,
        [x_m, y_m]: [f64; 2],
        denominator_m: f64,
    ) -> Result<Self, Refusal> {
        let (x, y) = (x_m / denominator_m, y_m / denominator_m);
        let squared = x * x + y * y;
        let inside = squared <= LARGEST_ECCENTRICITY * LARGEST_ECCENTRICITY;
        if !inside {
            return Err(Refusal {
                quantity,
                value: squared,
                allowed: "at most 0.3 of its denominator (the value is the square of this part)",
            });
        }
        let home_rad = small_arctangent(y / (1.0 - x));
        Ok(Self { x, y, home_rad })
    }

    /// `g(phi) - g(0)` and its slope: docs/equations.md, Capstan error.
    #[inline]
    fn angle(&self, phi_rad: f64) -> (f64, f64) {
        let (sine, cosine) = sine_cosine(phi_rad);
        let n = self.x * sine + self.y * cosine;
        let q = self.x * cosine - self.y * sine;
        let d = 1.0 - q;
        (
            small_arctangent(n / d) - self.home_rad,
            (q * d - n * n) / (n * n + d * d),
        )
    }
}

/// A capstan as a step needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedCapstan {
    offset: f64,
    ratio: f64,
    ratio_slope: f64,
    output: Drum,
    input: Drum,
}

impl PreparedCapstan {
    pub(crate) const fn new(capstan: &Capstan) -> Result<Self, Refusal> {
        let ratio = match bounded("transmission_ratio", capstan.transmission_ratio) {
            Ok(ratio) => ratio,
            Err(refusal) => return Err(refusal),
        };
        let deviation = match bounded("ratio_deviation", capstan.ratio_deviation) {
            Ok(deviation) => deviation,
            Err(refusal) => return Err(refusal),
        };
        let offset = match bounded("offset", capstan.offset) {
            Ok(offset) => offset,
            Err(refusal) => return Err(refusal),
        };
        let output_m = match length("drum_distance_m", capstan.drum_distance_m) {
            Ok(output_m) => output_m,
            Err(refusal) => return Err(refusal),
        };
        let input_m = match length("input_drum_denominator_m", capstan.input_drum_denominator_m) {
            Ok(input_m) => input_m,
            Err(refusal) => return Err(refusal),
        };
        if ratio == 0.0 {
            return Err(Refusal {
                quantity: "transmission_ratio",
                value: ratio,
                allowed: "other than 0",
            });
        }
        let ratio_slope = -deviation / (ratio + deviation);
        // infinite or NaN where the deviation cancels the ratio
        if !is_bounded(ratio_slope) {
            return Err(Refusal {
                quantity: "ratio_deviation",
                value: deviation,
                allowed: "not the negative of transmission_ratio",
            });
        }
        let output = match Drum::new("output_drum_xy_m", capstan.output_drum_xy_m, output_m) {
            Ok(output) => output,
            Err(refusal) => return Err(refusal),
        };
        let input = match Drum::new("input_drum_xy_m", capstan.input_drum_xy_m, input_m) {
            Ok(input) => input,
            Err(refusal) => return Err(refusal),
        };
        Ok(Self {
            offset,
            ratio,
            ratio_slope,
            output,
            input,
        })
    }

    /// Largest reading of which both drums' angles are within the sine's range.
    pub(crate) const fn largest_reading(&self) -> f64 {
        let ratio = self.ratio.abs();
        crate::LARGEST_ANGLE_RAD / if ratio > 1.0 { ratio } else { 1.0 }
    }

    /// Error and slope at a reading, Baser & Konukseven eq. (1).
    #[inline]
    pub(crate) fn error(&self, reading: f64) -> (f64, f64) {
        let (output, output_slope) = self.output.angle(reading);
        let (input, input_slope) = self.input.angle(self.ratio * reading);
        (
            self.offset + self.ratio_slope * reading + output + input,
            self.ratio_slope + output_slope + self.ratio * input_slope,
        )
    }
}
