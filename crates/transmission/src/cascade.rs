//! A capstan that drives a parallelogram: the capstan's output is the parallelogram's input.
//!
//! Both errors are angles added to the encoder angle, so that with the capstan's error `e_c` and the
//! parallelogram's `par` the joint is at `theta + total(theta)`,
//! `total(theta) = e_c(theta) + par(theta + e_c(theta)) - par(0)`.

use crate::capstan::{Capstan, CapstanError};
use crate::error::LawError;
use crate::evaluation::Evaluation;
use crate::inverse::invert;
use crate::parallelogram::Parallelogram;

/// A capstan drive followed by a parallelogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapstanParallelogram {
    /// The drive at the motor.
    pub capstan: Capstan,
    /// The loop at the joint.
    pub parallelogram: Parallelogram,
}

impl CapstanParallelogram {
    /// Error of the joint at the encoder angle `theta_rad` in rad; the value of [`Self::evaluate`].
    ///
    /// Source: docs/equations.md, Parallelogram error.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn error(
        &self,
        p: &CapstanError,
        deviations_m: &[f64; 4],
        theta_rad: f64,
    ) -> Result<f64, LawError> {
        Ok(self.evaluate(p, deviations_m, theta_rad)?.value_rad)
    }

    /// Error `e_c(theta) + par(theta + e_c(theta)) - par(0)` at the encoder angle `theta_rad`, its
    /// slope, and its derivatives: six with respect to the capstan's parameters (order of
    /// [`CapstanError::PARAMETER_NAMES`]), then four with respect to the lengths AB, BC, CE, EA.
    ///
    /// By the chain rule, with `u = theta + e_c(theta)`: the slope is `e_c' + par'(u) (1 + e_c')`, a
    /// capstan derivative is `(1 + par'(u)) de_c/dp`, a length derivative is that of `par` at `u`.
    /// Units: rad, rad/rad, rad per unit of the parameter.
    ///
    /// Source: Baser & Konukseven eq. (1) and (2); docs/equations.md, Parallelogram error.
    ///
    /// # Errors
    /// As [`Capstan::evaluate`] and [`Parallelogram::evaluate`].
    ///
    /// ```
    /// use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, Parallelogram};
    /// let joint = CapstanParallelogram {
    ///     capstan: Capstan::new(12.0, 0.0975, 0.0975)?,
    ///     parallelogram: Parallelogram::new([0.18, 0.076, 0.18, 0.076])?,
    /// };
    /// let at_home = joint.evaluate(&CapstanError::default(), &[-0.0005, -0.0007, 0.0, 0.0], 0.0)?;
    /// assert!(at_home.value_rad.abs() < 1e-15);
    /// # Ok::<(), haptical_transmission::LawError>(())
    /// ```
    pub fn evaluate(
        &self,
        p: &CapstanError,
        deviations_m: &[f64; 4],
        theta_rad: f64,
    ) -> Result<Evaluation<10>, LawError> {
        let capstan = self.capstan.evaluate(p, theta_rad)?;
        let loop_input_rad = theta_rad + capstan.value_rad;
        let parallelogram = self.parallelogram.evaluate(deviations_m, loop_input_rad)?;

        let gain = 1.0 + parallelogram.slope;
        let mut derivatives = [0.0; 10];
        let (of_capstan, of_lengths) = derivatives.split_at_mut(6);
        for (derivative, inner) in of_capstan.iter_mut().zip(capstan.derivatives) {
            *derivative = gain * inner;
        }
        of_lengths.copy_from_slice(&parallelogram.derivatives);
        Evaluation {
            value_rad: capstan.value_rad + parallelogram.value_rad,
            slope: capstan.slope + parallelogram.slope * (1.0 + capstan.slope),
            derivatives,
        }
        .checked()
    }

    /// The encoder angle in rad within `bracket_rad` at which the joint is at `output_rad`. The
    /// bracket, moved by the capstan's error, must lie within the loop's `-pi/2 .. pi/2`.
    ///
    /// Source: [`invert`] with this joint's error.
    ///
    /// # Errors
    /// As [`invert`] and [`Self::evaluate`].
    pub fn invert(
        &self,
        p: &CapstanError,
        deviations_m: &[f64; 4],
        output_rad: f64,
        bracket_rad: [f64; 2],
    ) -> Result<f64, LawError> {
        let error = |theta_rad| {
            self.evaluate(p, deviations_m, theta_rad)
                .map(|e| (e.value_rad, e.slope))
        };
        invert(error, output_rad, bracket_rad)
    }
}
