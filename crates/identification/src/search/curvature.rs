//! The part of the cost's second derivatives that Gauss and Newton leave out, from the gradients met on the way.

use haptical_linalg::Matrix;
use nalgebra::{DMatrix, DVector};

/// Normal matrix and gradient of half the cost: J'J and J'r.
#[derive(Debug)]
pub(crate) struct Normal {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    norms: Vec<f64>,
}

impl Normal {
    /// Of a factor F of unit columns, with the projected residuals q: J'J = N F'F N and J'r = N F'q, N the column norms.
    pub(crate) fn new(factor: &Matrix, projected: &[f64], norms: &[f64]) -> Self {
        let count = norms.len();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let entry =
            |a: usize, b: usize| norms[a] * norms[b] * product(factor.column(a), factor.column(b));
        Self {
            matrix: DMatrix::from_fn(count, count, entry),
            gradient: DVector::from_fn(count, |a, _| {
                norms[a] * product(factor.column(a), projected)
            }),
            norms: norms.to_vec(),
        }
    }
}

/// An estimate of S = sum_i r_i H_i, H_i the second derivatives of residual i: the whole second derivatives are J'J + S.
///
/// Where residuals stay large, as they do if the model lacks an effect, J'J alone takes hundreds of short steps to the minimum
/// (Dennis, Gay & Welsch 1981, An adaptive nonlinear least-squares algorithm; docs/equations.md, Searches).
#[derive(Debug)]
pub(crate) struct Curvature {
    second: DMatrix<f64>,
    /// Whether it foretold the last step better than J'J alone.
    is_closer: bool,
}

impl Curvature {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            second: DMatrix::zeros(count, count),
            is_closer: false,
        }
    }

    pub(crate) fn is_closer(&self) -> bool {
        self.is_closer
    }

    /// The step of (J'J + S + damping W'W) x = J'r, to be subtracted, and the fall of the cost that it promises; none where the matrix is
    /// not positive definite.
    pub(crate) fn step(
        &self,
        at: &Normal,
        damping: f64,
        weights: &[f64],
    ) -> Option<(Vec<f64>, f64)> {
        let count = at.norms.len();
        let inverse = |k: usize| match at.norms[k] > 0.0 {
            true => 1.0 / at.norms[k],
            false => 0.0,
        };
        let whole = &at.matrix + &self.second;
        let mut unit =
            DMatrix::from_fn(count, count, |a, b| inverse(a) * whole[(a, b)] * inverse(b));
        for (k, weight) in weights.iter().enumerate() {
            unit[(k, k)] += damping * weight * weight;
        }
        let right = DVector::from_fn(count, |k, _| inverse(k) * at.gradient[k]);
        let mut step = unit.cholesky()?.solve(&right);
        (0..count).for_each(|k| step[k] *= inverse(k));
        let promise = 2.0 * at.gradient.dot(&step) - step.dot(&(&whole * &step));
        let is_sound = promise.is_finite() && step.iter().all(|value| value.is_finite());
        is_sound.then(|| (step.as_slice().to_vec(), promise))
    }

    /// Learns from a step that was taken, `fall` what the cost fell by: S is sized down where it is too large, then changed least so that
    /// it makes up the change of gradient that J'J does not (the same, section 3, with the change of gradient of Broyden and Dennis).
    pub(crate) fn learn(&mut self, step: &[f64], fall: f64, [before, after]: [&Normal; 2]) {
        let step = DVector::from_column_slice(step);
        let along = &self.second * &step;
        let of_gradient = before.gradient.dot(&step);
        let linear = -2.0 * of_gradient - step.dot(&(&before.matrix * &step));
        let whole = linear - step.dot(&along);
        self.is_closer = (whole - fall).abs() < (linear - fall).abs();
        let change = &after.gradient - &before.gradient;
        let lacking = &change - &after.matrix * &step;
        let slope = change.dot(&step);
        if slope <= LEAST_SLOPE * change.norm() * step.norm() {
            return;
        }
        let have = step.dot(&along).abs();
        let size = match have > 0.0 {
            true => (step.dot(&lacking).abs() / have).min(1.0),
            false => 1.0,
        };
        self.second *= size;
        let rest = lacking - size * along;
        let both = (&rest * change.transpose() + &change * rest.transpose()) / slope;
        let twice = &change * change.transpose() * (rest.dot(&step) / (slope * slope));
        self.second += both - twice;
    }
}

/// Cosine of the change of gradient and the step below which the change says nothing.
const LEAST_SLOPE: f64 = 1e-8;
