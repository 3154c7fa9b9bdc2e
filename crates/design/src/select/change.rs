//! A pose that comes or goes, as a change of the covariance of a selection.

use nalgebra::{Cholesky, DMatrix};

/// C' = C - sign U U^T and K' = K - sign (U P^T + P U^T), with
///
///   U = C X^T L^-T,  L L^T = I + sign G,  P = Z - sign U B / 2,  Z = C W U,  B = U^T W U
///
/// for a pose with the rows X and G = X C X^T, and a weight W of which K = C W C. One reading is a rank-one update (Sherman & Morrison
/// 1950), q readings are a rank-q update (Woodbury 1950).
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// 1 for a pose that comes, -1 for one that goes.
    pub(crate) sign: f64,
    /// U.
    pub(crate) update: DMatrix<f64>,
    /// P, where there is a weight.
    pub(crate) pulled: Option<DMatrix<f64>>,
    /// ln det(I + sign G): the growth of ln det M.
    pub(crate) log_det: f64,
    /// Change of trace(W C).
    pub(crate) trace: f64,
}

/// Least eigenvalue of I - G with which a pose may be taken out: without it the others must fix every
/// parameter.
const LEAST_LEFT: f64 = 1e-9;

impl Change {
    /// The change by a pose with the rows `of` (as columns); none where what is left would not fix every parameter.
    pub(crate) fn new(
        of: nalgebra::DMatrixView<'_, f64>,
        covariance: &DMatrix<f64>,
        weight: Option<&DMatrix<f64>>,
        sign: f64,
    ) -> Option<Self> {
        let count = of.ncols();
        let along = covariance * of;
        let spread = of.tr_mul(&along);
        let factor = Cholesky::new(DMatrix::identity(count, count) + &spread * sign)?;
        let lower = factor.l();
        let diagonal = || (0..count).map(|index| lower[(index, index)]);
        if diagonal().any(|value| value.is_nan() || value * value < LEAST_LEFT) {
            return None;
        }
        let log_det = 2.0 * diagonal().map(f64::ln).sum::<f64>();
        let mut turned = along.transpose();
        lower.solve_lower_triangular_mut(&mut turned);
        let update = turned.transpose();
        let mut trace = 0.0;
        let pulled = weight.map(|weight| {
            let weighing = weight * &update;
            let inner = update.tr_mul(&weighing);
            trace = -sign * inner.trace();
            covariance * &weighing - &update * inner * (0.5 * sign)
        });
        Some(Self {
            sign,
            update,
            pulled,
            log_det,
            trace,
        })
    }

    /// Makes the change of C and K.
    pub(crate) fn make(&self, covariance: &mut DMatrix<f64>, weighted: &mut DMatrix<f64>) {
        for row in self.update.column_iter() {
            covariance.ger(-self.sign, &row, &row, 1.0);
        }
        if let Some(pulled) = &self.pulled {
            for (row, pulled) in self.update.column_iter().zip(pulled.column_iter()) {
                weighted.ger(-self.sign, &row, &pulled, 1.0);
                weighted.ger(-self.sign, &pulled, &row, 1.0);
            }
        }
    }

    /// Readings of the pose.
    pub(crate) fn readings(&self) -> usize {
        self.update.ncols()
    }
}
