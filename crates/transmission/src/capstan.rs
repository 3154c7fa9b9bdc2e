//! The error of a capstan drive: offset, ratio deviation and two eccentric drums, eq. (1).
//!
//! Short derivation (docs/equations.md, Capstan error). A drum that turns by `phi` about an axis at
//! distance `r` from its centre carries the centre to the angle `phi + beta`. Seen from the other end
//! of a line of centres of length `D`, the centre is then off that line by
//! `g(r, beta, phi) = atan[ r sin(phi + beta) / (D - r cos(phi + beta)) ]`, and the cable turns with
//! it. The output drum turns by `theta`, the input drum by `R theta`. With
//! `x = r cos beta`, `y = r sin beta`:
//!
//! ```text
//! r sin(phi + beta) = x sin phi + y cos phi
//! r cos(phi + beta) = x cos phi - y sin phi
//! ```
//!
//! so that the estimated parameters are `x` and `y`: `beta` has no meaning at `r = 0`, while `x` and
//! `y` and all derivatives stay smooth there.

use crate::capstan_terms::{CapstanTerms, Drum, TurnedDrum};
use crate::error::{LawError, finite, positive};
use crate::evaluation::Evaluation;
use crate::inverse::invert;

/// What is known of a capstan drive from its drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capstan {
    transmission_ratio: f64,
    drum_distance_m: f64,
    input_drum_denominator_m: f64,
}

/// The six parameters of a capstan's error; all zero for a drive without error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapstanError {
    /// Offset `c` at home, rad.
    pub offset_rad: f64,
    /// Deviation `R_e` of the ratio: the drive's ratio is `R + R_e`.
    pub ratio_deviation: f64,
    /// Centre of the output drum from its axis at home, `[r_o cos beta_o, r_o sin beta_o]`.
    pub output_drum_xy_m: [f64; 2],
    /// Centre of the input drum from its axis at home, `[r_i cos beta_i, r_i sin beta_i]`.
    pub input_drum_xy_m: [f64; 2],
}

impl CapstanError {
    /// Names of the parameters, in the order of [`Self::to_array`].
    pub const PARAMETER_NAMES: [&'static str; 6] = [
        "offset",
        "ratio_deviation",
        "output_drum_x",
        "output_drum_y",
        "input_drum_x",
        "input_drum_y",
    ];

    /// The parameters in the order of [`Self::PARAMETER_NAMES`].
    #[must_use]
    pub const fn to_array(&self) -> [f64; 6] {
        let [output_x, output_y] = self.output_drum_xy_m;
        let [input_x, input_y] = self.input_drum_xy_m;
        [
            self.offset_rad,
            self.ratio_deviation,
            output_x,
            output_y,
            input_x,
            input_y,
        ]
    }

    /// Inverse of [`Self::to_array`].
    #[must_use]
    pub const fn from_array(parameters: [f64; 6]) -> Self {
        let [
            offset_rad,
            ratio_deviation,
            output_x,
            output_y,
            input_x,
            input_y,
        ] = parameters;
        Self {
            offset_rad,
            ratio_deviation,
            output_drum_xy_m: [output_x, output_y],
            input_drum_xy_m: [input_x, input_y],
        }
    }

    /// The parameters from the polar form the paper prints: `x = r cos beta`, `y = r sin beta`, in m
    /// from m and rad.
    ///
    /// Source: Baser & Konukseven, Table 2; docs/equations.md, Capstan error.
    ///
    /// ```
    /// use haptical_transmission::CapstanError;
    /// let p = CapstanError::from_polar(0.0, 0.0, 2e-4, core::f64::consts::FRAC_PI_2, 0.0, 0.0);
    /// assert!(p.output_drum_xy_m[0].abs() < 1e-18 && p.output_drum_xy_m[1] == 2e-4);
    /// ```
    #[must_use]
    pub fn from_polar(
        offset_rad: f64,
        ratio_deviation: f64,
        r_o_m: f64,
        beta_o_rad: f64,
        r_i_m: f64,
        beta_i_rad: f64,
    ) -> Self {
        let (sin_o, cos_o) = libm::sincos(beta_o_rad);
        let (sin_i, cos_i) = libm::sincos(beta_i_rad);
        Self {
            offset_rad,
            ratio_deviation,
            output_drum_xy_m: [r_o_m * cos_o, r_o_m * sin_o],
            input_drum_xy_m: [r_i_m * cos_i, r_i_m * sin_i],
        }
    }

    /// Eccentricity in m and its direction in rad within `(-pi, pi]`, `(r_o, beta_o)`, of the output
    /// drum; the direction of a centred drum is given as 0.
    #[must_use]
    pub fn output_drum_polar(&self) -> (f64, f64) {
        polar(self.output_drum_xy_m)
    }

    /// Eccentricity in m and its direction in rad within `(-pi, pi]`, `(r_i, beta_i)`, of the input
    /// drum; the direction of a centred drum is given as 0.
    #[must_use]
    pub fn input_drum_polar(&self) -> (f64, f64) {
        polar(self.input_drum_xy_m)
    }
}

fn polar([x, y]: [f64; 2]) -> (f64, f64) {
    // Adding zero turns -0 into +0: atan2(0, -0) would be pi.
    (libm::hypot(x, y), libm::atan2(y + 0.0, x + 0.0))
}

impl Capstan {
    /// A drive of nominal ratio `R` (motor over output, negative if it reverses) whose drum axes are
    /// `drum_distance_m` apart. `input_drum_denominator_m` is the length under the input drum's
    /// eccentricity: eq. (1) as printed uses the drum distance for both drums, the paper's numbers
    /// need a shorter one for the input drum.
    ///
    /// Source: Baser & Konukseven eq. (1); docs/equations.md, Capstan error.
    ///
    /// # Errors
    /// [`LawError::NonFinite`] for a number that is not finite,
    /// [`LawError::OutOfRange`] for a ratio of 0 or a distance that is not positive.
    pub fn new(
        transmission_ratio: f64,
        drum_distance_m: f64,
        input_drum_denominator_m: f64,
    ) -> Result<Self, LawError> {
        if finite("transmission ratio", transmission_ratio)? == 0.0 {
            return Err(LawError::OutOfRange {
                quantity: "transmission ratio",
                value: transmission_ratio,
                allowed: "other than 0",
            });
        }
        Ok(Self {
            transmission_ratio,
            drum_distance_m: positive("drum distance, m", drum_distance_m)?,
            input_drum_denominator_m: positive(
                "input drum denominator, m",
                input_drum_denominator_m,
            )?,
        })
    }

    /// Nominal ratio `R`, motor over output.
    #[must_use]
    pub const fn transmission_ratio(&self) -> f64 {
        self.transmission_ratio
    }

    /// Distance `D` of the two drum axes, m.
    #[must_use]
    pub const fn drum_distance_m(&self) -> f64 {
        self.drum_distance_m
    }

    /// Length under the input drum's eccentricity, m.
    #[must_use]
    pub const fn input_drum_denominator_m(&self) -> f64 {
        self.input_drum_denominator_m
    }

    /// Error at the encoder angle `theta_rad` in rad; the value of [`Self::evaluate`].
    ///
    /// Source: Baser & Konukseven eq. (1).
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    ///
    /// ```
    /// use haptical_transmission::{Capstan, CapstanError};
    /// let drive = Capstan::new(8.0, 0.0675, 0.0675)?;
    /// let longer = CapstanError { ratio_deviation: 2.0, ..CapstanError::default() };
    /// // the drive turns 8/10 of what the encoder says
    /// assert!((drive.error(&longer, 0.5)? - (0.4 - 0.5)).abs() < 1e-15);
    /// # Ok::<(), haptical_transmission::LawError>(())
    /// ```
    pub fn error(&self, p: &CapstanError, theta_rad: f64) -> Result<f64, LawError> {
        Ok(self.evaluate(p, theta_rad)?.value_rad)
    }

    /// Error at the encoder angle `theta_rad` (the motor angle over `R`), its slope and its six
    /// derivatives in the order of [`CapstanError::PARAMETER_NAMES`]:
    ///
    /// `c - R_e / (R_e + R) theta + [g_o(theta) - g_o(0)] + [g_i(R theta) - g_i(0)]`,
    /// `g(phi) = atan2(x sin phi + y cos phi, D - x cos phi + y sin phi)`,
    ///
    /// where `D` is the drum distance for the output drum `g_o` and the input drum's denominator for
    /// `g_i`. Units: rad, rad/rad, then rad/rad, rad, and rad/m for the four eccentricities.
    ///
    /// Source: Baser & Konukseven eq. (1); docs/equations.md, Capstan error.
    ///
    /// # Errors
    /// [`LawError::NonFinite`] for a number that is not finite or a result that overflows,
    /// [`LawError::SingularRatio`] for `R_e + R = 0` up to rounding,
    /// [`LawError::EccentricityTooLarge`] for an eccentricity that is not less than its `D`.
    pub fn evaluate(&self, p: &CapstanError, theta_rad: f64) -> Result<Evaluation<6>, LawError> {
        for (parameter, name) in p.to_array().into_iter().zip(CapstanError::PARAMETER_NAMES) {
            finite(name, parameter)?;
        }
        finite("encoder angle, rad", theta_rad)?;
        let ratio = self.transmission_ratio;
        let input_angle_rad = finite("input drum angle, rad", ratio * theta_rad)?;

        let actual_ratio = finite("actual ratio", ratio + p.ratio_deviation)?;
        // Below the rounding of the sum its sign, and so the sign of the error, is arbitrary.
        if actual_ratio.abs() <= f64::EPSILON * ratio.abs() {
            return Err(LawError::SingularRatio {
                transmission_ratio: ratio,
                ratio_deviation: p.ratio_deviation,
            });
        }
        check_eccentricity("output", p.output_drum_xy_m, self.drum_distance_m)?;
        check_eccentricity("input", p.input_drum_xy_m, self.input_drum_denominator_m)?;

        let terms = self.terms(p);
        let output = terms.output.turned(libm::sincos(theta_rad));
        let input = terms.input.turned(libm::sincos(input_angle_rad));
        let [output_x, output_y] = per_xy_from_home(&terms.output, &output);
        let [input_x, input_y] = per_xy_from_home(&terms.input, &input);
        let drums_rad = [
            angle_rad(&output) - angle_rad(&terms.output.home()),
            angle_rad(&input) - angle_rad(&terms.input.home()),
        ];
        Evaluation {
            value_rad: terms.value_rad(theta_rad, drums_rad),
            slope: terms.slope(&output, &input),
            derivatives: [
                1.0,
                terms.per_ratio_rad(theta_rad),
                output_x,
                output_y,
                input_x,
                input_y,
            ],
        }
        .checked()
    }

    /// Eq. (1) with parameters that are allowed.
    pub(crate) const fn terms(&self, p: &CapstanError) -> CapstanTerms {
        let denominators_m = [self.drum_distance_m, self.input_drum_denominator_m];
        CapstanTerms::new(self.transmission_ratio, denominators_m, p)
    }

    /// The encoder angle in rad within `bracket_rad` at which the output is at `output_rad`.
    ///
    /// Source: [`invert`] with this drive's error.
    ///
    /// # Errors
    /// As [`invert`] and [`Self::evaluate`].
    ///
    /// ```
    /// use haptical_transmission::{Capstan, CapstanError};
    /// let drive = Capstan::new(8.0, 0.0675, 0.0675)?;
    /// let p = CapstanError::from_polar(0.001, -0.02, 2e-4, -0.2, 2.5e-6, 2.4);
    /// let theta_rad = drive.invert(&p, 0.4, [-1.6, 1.6])?;
    /// assert!((theta_rad + drive.error(&p, theta_rad)? - 0.4).abs() < 1e-12);
    /// # Ok::<(), haptical_transmission::LawError>(())
    /// ```
    pub fn invert(
        &self,
        p: &CapstanError,
        output_rad: f64,
        bracket_rad: [f64; 2],
    ) -> Result<f64, LawError> {
        let error = |theta_rad| self.evaluate(p, theta_rad).map(|e| (e.value_rad, e.slope));
        invert(error, output_rad, bracket_rad)
    }
}

/// Refuses a drum whose centre is not nearer to its axis than `D`.
fn check_eccentricity(
    drum: &'static str,
    [x_m, y_m]: [f64; 2],
    denominator_m: f64,
) -> Result<(), LawError> {
    let eccentricity_m = libm::hypot(x_m, y_m);
    if eccentricity_m < denominator_m {
        Ok(())
    } else {
        Err(LawError::EccentricityTooLarge {
            drum,
            eccentricity_m,
            denominator_m,
        })
    }
}

/// The drum's angle `g`.
fn angle_rad(drum: &TurnedDrum) -> f64 {
    libm::atan2(drum.n, drum.d)
}

/// Derivatives of `g(phi) - g(0)`: the encoder reads zero at home, whatever the drum's orientation there.
fn per_xy_from_home(drum: &Drum, turned: &TurnedDrum) -> [f64; 2] {
    let ([x, y], [home_x, home_y]) = (turned.per_xy(), drum.home().per_xy());
    [x - home_x, y - home_y]
}
