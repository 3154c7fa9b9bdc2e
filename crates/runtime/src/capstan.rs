//! The error of a capstan drive, eq. (1), with what does not change worked out beforehand.

use haptical_kinematics::trigonometry::{LARGEST_RAD, sine_cosine, small_arctangent};
use haptical_transmission::{CapstanError, CapstanTerms, Drum};

use crate::error::{Refusal, attempt, bounded, is_bounded, length};

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

/// The drum's angle at home.
const fn home_rad(quantity: &'static str, drum: &Drum) -> Result<f64, Refusal> {
    let squared = drum.eccentricity_squared();
    let inside = squared <= LARGEST_ECCENTRICITY * LARGEST_ECCENTRICITY;
    if inside {
        Ok(small_arctangent(drum.home().tangent()))
    } else {
        Err(Refusal {
            quantity,
            value: squared,
            allowed: "at most 0.3 of its denominator (the value is the square of this part)",
        })
    }
}

/// A capstan as a step needs it: eq. (1) with sines and an arctangent of fixed work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PreparedCapstan {
    terms: CapstanTerms,
    /// Angles of the output and the input drum at home.
    homes_rad: [f64; 2],
}

impl PreparedCapstan {
    pub(crate) const fn new(capstan: &Capstan) -> Result<Self, Refusal> {
        let ratio = attempt!(bounded("transmission_ratio", capstan.transmission_ratio));
        let deviation = attempt!(bounded("ratio_deviation", capstan.ratio_deviation));
        let offset = attempt!(bounded("offset", capstan.offset));
        let output_m = attempt!(length("drum_distance_m", capstan.drum_distance_m));
        let input_m = attempt!(length(
            "input_drum_denominator_m",
            capstan.input_drum_denominator_m
        ));
        if ratio == 0.0 {
            return Err(Refusal {
                quantity: "transmission_ratio",
                value: ratio,
                allowed: "other than 0",
            });
        }
        let error = CapstanError {
            offset_rad: offset,
            ratio_deviation: deviation,
            output_drum_xy_m: capstan.output_drum_xy_m,
            input_drum_xy_m: capstan.input_drum_xy_m,
        };
        let terms = CapstanTerms::new(ratio, [output_m, input_m], &error);
        // infinite or NaN where the deviation cancels the ratio
        if !is_bounded(terms.ratio_slope()) {
            return Err(Refusal {
                quantity: "ratio_deviation",
                value: deviation,
                allowed: "not the negative of transmission_ratio",
            });
        }
        let homes_rad = [
            attempt!(home_rad("output_drum_xy_m", &terms.output)),
            attempt!(home_rad("input_drum_xy_m", &terms.input)),
        ];
        Ok(Self { terms, homes_rad })
    }

    /// Largest reading of which both drums' angles are within the sine's range.
    pub(crate) const fn largest_reading(&self) -> f64 {
        let ratio = self.terms.ratio().abs();
        LARGEST_RAD / if ratio > 1.0 { ratio } else { 1.0 }
    }

    /// Error and slope at a reading, Baser & Konukseven eq. (1).
    #[inline]
    pub(crate) fn error(&self, reading: f64) -> (f64, f64) {
        let output = self.terms.output.turned(sine_cosine(reading));
        let input = self
            .terms
            .input
            .turned(sine_cosine(self.terms.ratio() * reading));
        let [output_home_rad, input_home_rad] = self.homes_rad;
        let drums_rad = [
            small_arctangent(output.tangent()) - output_home_rad,
            small_arctangent(input.tangent()) - input_home_rad,
        ];
        (
            self.terms.value_rad(reading, drums_rad),
            self.terms.slope(&output, &input),
        )
    }
}
