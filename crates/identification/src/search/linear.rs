//! The linearised problem of a search: reduced from rows, or from a triangle that the problem hands over.

use haptical_linalg::{Reduction, Solution};

use crate::IdentificationError;
use crate::search::curvature::Normal;
use crate::search::triangle::UnitTriangle;

/// The linearised problem at one point.
#[derive(Debug)]
pub(crate) enum Linear {
    /// Reduced by a pivoted QR of all rows.
    Rows(Reduction),
    /// Reduced by the problem itself.
    Triangle(Box<UnitTriangle>),
}

impl Linear {
    /// Euclidean norms of the columns.
    pub(crate) fn column_norms(&self) -> &[f64] {
        match self {
            Self::Rows(reduction) => reduction.column_norms(),
            Self::Triangle(triangle) => &triangle.norms,
        }
    }

    /// The undamped step.
    pub(crate) fn newton(
        &self,
        columns: &[usize],
        tolerance: f64,
    ) -> Result<Solution, IdentificationError> {
        match self {
            Self::Rows(reduction) => Ok(reduction.solve(columns, 0.0, tolerance)?),
            Self::Triangle(triangle) => match triangle.newton(tolerance) {
                Some(step) => Ok(step),
                None => Ok(triangle.reduction()?.solve(columns, 0.0, tolerance)?),
            },
        }
    }

    /// The step damped by `damping` times the weighted column norms.
    pub(crate) fn damped(
        &self,
        columns: &[usize],
        (damping, weights): (f64, &[f64]),
        tolerance: f64,
    ) -> Result<Solution, IdentificationError> {
        let solve = |reduction: &Reduction| {
            Ok(reduction.solve_weighted(columns, damping, weights, tolerance)?)
        };
        match self {
            Self::Rows(reduction) => solve(reduction),
            Self::Triangle(triangle) => match triangle.damped(damping, weights, tolerance) {
                Some(step) => Ok(step),
                None => solve(&triangle.reduction()?),
            },
        }
    }

    /// Normal matrix and gradient, of all columns.
    pub(crate) fn normal(&self, columns: &[usize]) -> Result<Normal, IdentificationError> {
        let of = |reduction: &Reduction| -> Result<Normal, IdentificationError> {
            let factor = reduction.scaled_factor(columns, &vec![1.0; columns.len()])?;
            let norms = reduction.column_norms();
            Ok(Normal::new(&factor, reduction.projected(), norms))
        };
        match self {
            Self::Rows(reduction) => of(reduction),
            Self::Triangle(triangle) => of(&triangle.reduction()?),
        }
    }

    pub(crate) fn into_reduction(self) -> Result<Reduction, IdentificationError> {
        match self {
            Self::Rows(reduction) => Ok(reduction),
            Self::Triangle(triangle) => triangle.reduction(),
        }
    }
}
