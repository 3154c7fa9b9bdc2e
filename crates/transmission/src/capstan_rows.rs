//! Eq. (1) at many encoder angles at once.

use crate::capstan_terms::Drum;
use crate::error::LawError;
use crate::{Capstan, CapstanError};

/// Many encoder angles of one capstan, with the sines and cosines of its drums' angles.
///
/// A second form of [`Capstan::evaluate`], because a fit evaluates the same angles again and again: the
/// sines do not change with the parameters, and the loops over slices become lanes. Arctangents are a short
/// series; drums too eccentric for it take the first form. Both agree to rounding.
///
/// ```
/// use haptical_transmission::{Capstan, CapstanError, CapstanRows};
/// let capstan = Capstan::new(8.0, 0.07, 0.07)?;
/// let p = CapstanError { offset_rad: 1e-3, output_drum_xy_m: [2e-4, 1e-4], ..CapstanError::default() };
/// let theta_rad = 0.3_f64;
/// let rows = CapstanRows {
///     capstan,
///     angles_rad: &[theta_rad],
///     output: [&[theta_rad.sin()], &[theta_rad.cos()]],
///     input: [&[(8.0 * theta_rad).sin()], &[(8.0 * theta_rad).cos()]],
/// };
/// let mut values_rad = [0.0];
/// rows.evaluate(&p, &mut values_rad, None)?;
/// assert!((values_rad[0] - capstan.error(&p, theta_rad)?).abs() < 1e-16);
/// # Ok::<(), haptical_transmission::LawError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CapstanRows<'a> {
    /// The drive.
    pub capstan: Capstan,
    /// Encoder angles, rad.
    pub angles_rad: &'a [f64],
    /// Sines and cosines of the encoder angles.
    pub output: [&'a [f64]; 2],
    /// Sines and cosines of the ratio times the encoder angles.
    pub input: [&'a [f64]; 2],
}

impl CapstanRows<'_> {
    /// Errors in rad and, where wanted, their six derivatives in the order of
    /// [`CapstanError::PARAMETER_NAMES`]; all slices have one entry per angle.
    ///
    /// Source: Baser & Konukseven eq. (1); docs/equations.md, Capstan error.
    ///
    /// # Errors
    /// As [`Capstan::evaluate`], for the parameters.
    pub fn evaluate(
        &self,
        p: &CapstanError,
        values_rad: &mut [f64],
        derivatives: Option<[&mut [f64]; 6]>,
    ) -> Result<(), LawError> {
        // says whether the parameters are allowed
        self.capstan.evaluate(p, 0.0)?;
        let terms = self.capstan.terms(p);
        if !(is_small(&terms.output) && is_small(&terms.input)) {
            return self.one_by_one(p, values_rad, derivatives);
        }
        for (value_rad, theta_rad) in values_rad.iter_mut().zip(self.angles_rad) {
            *value_rad = terms.centred_rad(*theta_rad);
        }
        let drums = [(&terms.output, self.output), (&terms.input, self.input)];
        let Some([offset, ratio, output_x, output_y, input_x, input_y]) = derivatives else {
            for (drum, angles) in drums.into_iter().filter(|(drum, _)| !drum.is_centred()) {
                add_angles(drum, angles, values_rad);
            }
            return Ok(());
        };
        offset.fill(1.0);
        let per_ratio = terms.per_ratio_and_angle();
        for (derivative, theta_rad) in ratio.iter_mut().zip(self.angles_rad) {
            *derivative = per_ratio * theta_rad;
        }
        let columns = [[output_x, output_y], [input_x, input_y]];
        for ((drum, angles), per_xy) in drums.into_iter().zip(columns) {
            add_with_derivatives(drum, angles, values_rad, per_xy);
        }
        Ok(())
    }

    /// By the first form, for drums too eccentric for the series.
    #[cold]
    fn one_by_one(
        &self,
        p: &CapstanError,
        values_rad: &mut [f64],
        mut derivatives: Option<[&mut [f64]; 6]>,
    ) -> Result<(), LawError> {
        for (row, theta_rad) in self.angles_rad.iter().enumerate() {
            let evaluation = self.capstan.evaluate(p, *theta_rad)?;
            values_rad[row] = evaluation.value_rad;
            for (column, derivative) in derivatives.iter_mut().flatten().zip(evaluation.derivatives)
            {
                column[row] = derivative;
            }
        }
        Ok(())
    }

    /// Slopes of the joint's angle at all encoder angles, one more than those of the error, rad/rad; for
    /// parameters that [`Capstan::evaluate`] allows.
    pub fn output_slopes(&self, p: &CapstanError) -> impl Iterator<Item = f64> {
        let terms = self.capstan.terms(p);
        let ([sines, cosines], [input_sines, input_cosines]) = (self.output, self.input);
        let output = sines.iter().zip(cosines);
        let input = input_sines.iter().zip(input_cosines);
        output
            .zip(input)
            .map(move |((&sine, &cosine), (&input_sine, &input_cosine))| {
                let output = terms.output.turned((sine, cosine));
                let input = terms.input.turned((input_sine, input_cosine));
                1.0 + terms.ratio_slope() + output.slope() + terms.ratio() * input.slope()
            })
    }
}

fn add_angles(drum: &Drum, [sines, cosines]: [&[f64]; 2], values_rad: &mut [f64]) {
    let home_rad = series_arctangent(drum.home().tangent());
    for (value_rad, (&sine, &cosine)) in values_rad.iter_mut().zip(sines.iter().zip(cosines)) {
        *value_rad += series_arctangent(drum.turned((sine, cosine)).tangent()) - home_rad;
    }
}

/// As [`add_angles`], with the derivatives from home.
fn add_with_derivatives(
    drum: &Drum,
    [sines, cosines]: [&[f64]; 2],
    values_rad: &mut [f64],
    [per_x, per_y]: [&mut [f64]; 2],
) {
    let home_rad = series_arctangent(drum.home().tangent());
    let per_home = drum.home().per_xy_by_reciprocal();
    let angles = sines.iter().zip(cosines);
    let into = values_rad.iter_mut().zip(per_x.iter_mut().zip(per_y));
    for ((value_rad, (per_x, per_y)), (&sine, &cosine)) in into.zip(angles) {
        let turned = drum.turned((sine, cosine));
        *value_rad += series_arctangent(turned.tangent()) - home_rad;
        let here = turned.per_xy_by_reciprocal();
        *per_x = here[0] - per_home[0];
        *per_y = here[1] - per_home[1];
    }
}

/// Up to here the series below is exact to rounding: the next term is t^12 / 13 of the first.
const SMALL_TANGENT: f64 = 0.04;

/// Whether no tangent can exceed [`SMALL_TANGENT`]: |n / d| <= e / (1 - e), e the eccentricity over D.
fn is_small(drum: &Drum) -> bool {
    let eccentricity = libm::sqrt(drum.eccentricity_squared());
    eccentricity <= SMALL_TANGENT * (1.0 - eccentricity)
}

/// atan t = t - t^3/3 + ... - t^11/11: a capstan's drums are centred to a hundredth of their distance.
#[inline]
fn series_arctangent(tangent: f64) -> f64 {
    let square = tangent * tangent;
    let mut sum = -1.0 / 11.0;
    for coefficient in [1.0 / 9.0, -1.0 / 7.0, 0.2, -1.0 / 3.0] {
        sum = sum * square + coefficient;
    }
    tangent + tangent * square * sum
}
