//! Held parameters beside noise with memory: what their plausible sizes and the residuals say of them.

use haptical_linalg::Matrix;
use nalgebra::{Cholesky, DMatrix, DVector};

use super::rows::as_matrix;

/// What a fit says of parameters that it held.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldEffect {
    /// Change of each fitted parameter (row) with a unit error of each held one (column).
    pub sensitivity: Matrix,
    /// A^T A, where A is what the fit cannot make up of the held parameters' derivatives.
    pub information: Matrix,
    /// Covariance of A^T r by the noise, with r the residuals.
    pub scatter: Matrix,
    /// A^T r.
    pub gradient: Vec<f64>,
}

/// What the residuals say of a parameter of plausible size, in variances of the noise, below which they say nothing: a millionth of
/// its plausible variance.
const LEAST_KNOWN: f64 = 1e-6;
/// Added to the unit diagonal of the scatter: directions of held parameters that the fit makes up say nothing.
const RIDGE: f64 = 1e-10;

impl HeldEffect {
    /// Second moment of the errors of some of the held parameters, of plausible sizes P: with N the information, K the
    /// scatter and g the gradient, M = (P^-2 + N K^-1 N)^-1, m = -M N K^-1 g, and M + m m^T. None where that is no number.
    ///
    /// The others' errors are not counted. Source: docs/equations.md, Covariance and intervals.
    #[must_use]
    pub fn second_moment(&self, some: &[usize], sizes: &[f64]) -> Option<Matrix> {
        let count = some.len();
        // where the fit reproduces all that a parameter does, what is left is rounding, of either sign
        let known: Vec<bool> = (some.iter().zip(sizes))
            .map(|(&k, size)| {
                self.information[(k, k)] * size * size > LEAST_KNOWN && self.scatter[(k, k)] > 0.0
            })
            .collect();
        let in_sizes = |of: &Matrix| {
            DMatrix::from_fn(count, count, |a, b| match known[a] && known[b] {
                true => of[(some[a], some[b])] * sizes[a] * sizes[b],
                false => 0.0,
            })
        };
        let (information, scatter) = (in_sizes(&self.information), in_sizes(&self.scatter));
        let gradient = DVector::from_fn(count, |k, _| match known[k] {
            true => self.gradient[some[k]] * sizes[k],
            false => 0.0,
        });
        let deviation = |k: usize| match known[k] {
            true => scatter[(k, k)].sqrt(),
            false => 1.0,
        };
        let deviations: Vec<f64> = (0..count).map(deviation).collect();
        let unit = DMatrix::from_fn(count, count, |a, b| {
            let ridge = if a == b { RIDGE } else { 0.0 };
            scatter[(a, b)] / deviations[a] / deviations[b] + ridge
        });
        let unit = Cholesky::new(unit)?;
        let over = DMatrix::from_fn(count, count, |a, b| information[(a, b)] / deviations[a]);
        let scaled = DVector::from_fn(count, |k, _| gradient[k] / deviations[k]);
        let mut precision = over.tr_mul(&unit.solve(&over));
        for k in 0..count {
            precision[(k, k)] += 1.0;
        }
        let moment = Cholesky::new(precision)?.inverse();
        let mean = &moment * over.tr_mul(&unit.solve(&scaled));
        let whole = DMatrix::from_fn(count, count, |a, b| {
            sizes[a] * sizes[b] * (moment[(a, b)] + mean[a] * mean[b])
        });
        whole
            .iter()
            .all(|entry| entry.is_finite())
            .then(|| as_matrix(&whole))
    }
}

#[cfg(test)]
mod tests {
    use super::HeldEffect;
    use haptical_linalg::Matrix;

    /// One parameter: the prior of size P against a measurement g / N with standard deviation sqrt(K) / N.
    #[test]
    fn a_single_parameter_is_weighed_by_its_noise() {
        let one = |value: f64| Matrix::from_fn(1, 1, |_, _| value);
        let effect = HeldEffect {
            sensitivity: one(0.0),
            information: one(4.0),
            scatter: one(9.0),
            gradient: vec![-6.0],
        };
        // P = 2: precision 1/4 + 16/9; mean (4 * 6 / 9) / precision
        let precision = 0.25 + 16.0 / 9.0;
        let mean = 24.0 / 9.0 / precision;
        let found = effect.second_moment(&[0], &[2.0]).unwrap()[(0, 0)];
        assert!(
            (found - (1.0 / precision + mean * mean)).abs() < 1e-8,
            "{found}"
        );
    }

    /// Rounding of either sign, next to a parameter of which the readings say something: also where products of two such are larger than
    /// their squares.
    #[test]
    fn rounding_says_nothing_and_hides_nothing() {
        for rounding in [-1e-20, 0.0, 1e-20] {
            let three = |first: f64| {
                Matrix::from_fn(3, 3, |row, column| match (row, column) {
                    (0, 0) => first,
                    (1, 2) | (2, 1) => 2.0 * rounding,
                    _ => rounding,
                })
            };
            let effect = HeldEffect {
                sensitivity: three(0.0),
                information: three(4.0),
                scatter: three(9.0),
                gradient: vec![-6.0, rounding, rounding],
            };
            let found = effect.second_moment(&[0, 1, 2], &[2.0, 3.0, 1.0]).unwrap();
            let alone = effect.second_moment(&[0], &[2.0]).unwrap();
            assert!((found[(0, 0)] - alone[(0, 0)]).abs() < 1e-8, "{rounding}");
            assert!((found[(1, 1)] - 9.0).abs() < 1e-6, "{rounding}");
            assert!((found[(2, 2)] - 1.0).abs() < 1e-6, "{rounding}");
        }
    }

    #[test]
    fn what_the_fit_makes_up_keeps_its_plausible_size() {
        let one = |value: f64| Matrix::from_fn(1, 1, |_, _| value);
        let effect = HeldEffect {
            sensitivity: one(1.0),
            information: one(1e-22),
            scatter: one(1e-22),
            gradient: vec![1e-12],
        };
        let found = effect.second_moment(&[0], &[3.0]).unwrap()[(0, 0)];
        assert!((found - 9.0).abs() < 1e-6, "{found}");
    }
}
