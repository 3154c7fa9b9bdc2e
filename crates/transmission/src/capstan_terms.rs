//! Eq. (1) without its elementary functions: the one text that every form of the capstan's error uses.
//!
//! [`Capstan::evaluate`](crate::Capstan::evaluate) takes sines and arctangents from `libm`,
//! [`CapstanRows`](crate::CapstanRows) takes known sines and a series, a control loop takes functions of
//! fixed work that the compiler can evaluate. The formulas between them are here, usable in constants.

use crate::CapstanError;

/// An eccentric drum: the centre's offset at home over the denominator `D`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drum {
    x: f64,
    y: f64,
    denominator_m: f64,
}

impl Drum {
    /// A drum whose centre lies at `xy_m` from its axis at home; `denominator_m` is positive.
    #[must_use]
    pub const fn new([x_m, y_m]: [f64; 2], denominator_m: f64) -> Self {
        Self {
            x: x_m / denominator_m,
            y: y_m / denominator_m,
            denominator_m,
        }
    }

    /// Whether the centre is on the axis.
    pub(crate) const fn is_centred(&self) -> bool {
        self.x == 0.0 && self.y == 0.0
    }

    /// Square of the eccentricity over the denominator.
    #[must_use]
    pub const fn eccentricity_squared(&self) -> f64 {
        self.x * self.x + self.y * self.y
    }

    /// The drum turned by `phi`, whose sine and cosine are given.
    #[inline]
    #[must_use]
    pub const fn turned(&self, (sine, cosine): (f64, f64)) -> TurnedDrum {
        let q = self.x * cosine - self.y * sine;
        TurnedDrum {
            sine,
            cosine,
            n: self.x * sine + self.y * cosine,
            q,
            d: 1.0 - q,
            denominator_m: self.denominator_m,
        }
    }

    /// The drum at home.
    #[inline]
    #[must_use]
    pub const fn home(&self) -> TurnedDrum {
        self.turned((0.0, 1.0))
    }
}

/// A drum turned by `phi`. With `n = x sin phi + y cos phi` and `d = 1 - (x cos phi - y sin phi)` (lengths
/// over `D`) its angle is `g = atan(n / d)`; `d > 0` because the eccentricity is less than `D`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedDrum {
    sine: f64,
    cosine: f64,
    pub(crate) n: f64,
    q: f64,
    pub(crate) d: f64,
    denominator_m: f64,
}

impl TurnedDrum {
    /// Tangent `n / d` of the drum's angle `g`.
    #[inline]
    #[must_use]
    pub const fn tangent(&self) -> f64 {
        self.n / self.d
    }

    /// `dg / d phi`: since `dn/dphi = 1 - d` and `dd/dphi = n`, it is `((1 - d) d - n^2) / (n^2 + d^2)`.
    #[inline]
    #[must_use]
    pub const fn slope(&self) -> f64 {
        (self.q * self.d - self.n * self.n) / (self.n * self.n + self.d * self.d)
    }

    /// `dg / dx` and `dg / dy`, rad/m.
    #[inline]
    #[must_use]
    pub const fn per_xy(&self) -> [f64; 2] {
        let ([x, y], [scale, denominator_m]) = self.fractions();
        [x / scale / denominator_m, y / scale / denominator_m]
    }

    /// As [`Self::per_xy`] with one division, for loops over many angles: another rounding.
    #[inline]
    pub(crate) const fn per_xy_by_reciprocal(&self) -> [f64; 2] {
        let ([x, y], [scale, denominator_m]) = self.fractions();
        let reciprocal = 1.0 / (scale * denominator_m);
        [x * reciprocal, y * reciprocal]
    }

    /// Numerators of the derivatives with respect to x and y, and the two factors of their denominator.
    #[inline]
    const fn fractions(&self) -> ([f64; 2], [f64; 2]) {
        let x = self.sine * self.d + self.n * self.cosine;
        let y = self.cosine * self.d - self.n * self.sine;
        let scale = self.n * self.n + self.d * self.d;
        ([x, y], [scale, self.denominator_m])
    }
}

/// Eq. (1) with what its parameters fix worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapstanTerms {
    offset: f64,
    ratio: f64,
    actual_ratio: f64,
    ratio_slope: f64,
    /// The output drum, which turns by the encoder angle.
    pub output: Drum,
    /// The input drum, which turns by the ratio times the encoder angle.
    pub input: Drum,
}

impl CapstanTerms {
    /// The terms of a drive of nominal ratio `R` whose drums have the denominators `[D_o, D_i]`. Nothing is
    /// checked: the numbers are such as [`Capstan::new`](crate::Capstan::new) and
    /// [`Capstan::evaluate`](crate::Capstan::evaluate) allow.
    #[must_use]
    pub const fn new(ratio: f64, denominators_m: [f64; 2], p: &CapstanError) -> Self {
        let actual_ratio = ratio + p.ratio_deviation;
        Self {
            offset: p.offset_rad,
            ratio,
            actual_ratio,
            ratio_slope: -p.ratio_deviation / actual_ratio,
            output: Drum::new(p.output_drum_xy_m, denominators_m[0]),
            input: Drum::new(p.input_drum_xy_m, denominators_m[1]),
        }
    }

    /// Nominal ratio `R`.
    #[must_use]
    pub const fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Slope of the error of a drive with centred drums: `-R_e / (R_e + R)`.
    #[must_use]
    pub const fn ratio_slope(&self) -> f64 {
        self.ratio_slope
    }

    /// Error in rad of a drive with centred drums: offset and ratio.
    #[inline]
    #[must_use]
    pub const fn centred_rad(&self, theta_rad: f64) -> f64 {
        self.offset + self.ratio_slope * theta_rad
    }

    /// Error in rad, with the angles from home of the output and the input drum.
    #[inline]
    #[must_use]
    pub const fn value_rad(&self, theta_rad: f64, [output_rad, input_rad]: [f64; 2]) -> f64 {
        self.centred_rad(theta_rad) + output_rad + input_rad
    }

    /// Slope of the error, rad/rad, with the two drums turned by `theta` and `R theta`.
    #[inline]
    #[must_use]
    pub const fn slope(&self, output: &TurnedDrum, input: &TurnedDrum) -> f64 {
        self.ratio_slope + output.slope() + self.ratio * input.slope()
    }

    /// Derivative of the error with respect to the ratio's deviation, rad.
    #[inline]
    #[must_use]
    pub const fn per_ratio_rad(&self, theta_rad: f64) -> f64 {
        -(self.ratio / self.actual_ratio) * (theta_rad / self.actual_ratio)
    }

    /// As [`Self::per_ratio_rad`] per rad of `theta`, for loops over many angles: another rounding.
    pub(crate) const fn per_ratio_and_angle(&self) -> f64 {
        -(self.ratio / self.actual_ratio) / self.actual_ratio
    }
}
