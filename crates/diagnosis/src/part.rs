//! Rows that a fit sees, and one Gauss-Newton step on them.

use haptical_identification::{Matrix, Reduction};
use haptical_linalg::{OrthonormalBasis, RANK_TOLERANCE};

use crate::DiagnosisError;
use crate::base::BaseProblem;
use crate::blocks::Blocks;
use crate::context::Context;
use crate::signal::Signal;
use crate::system::{compress_matrix, compress_rows, dot, take_off};

/// Rows that a fit sees: their blocks, and the base model's derivatives on them.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) blocks: Blocks,
    /// Compressed derivatives of the free parameters.
    pub(crate) free: Matrix,
    /// Their decomposition; none without parameters.
    pub(crate) basis: Option<OrthonormalBasis>,
}

/// A Gauss-Newton step of base model and causes.
pub(crate) struct Step {
    /// Free parameters, then the causes' numbers.
    pub(crate) values: Vec<f64>,
    /// Root mean square change of the predictions, in noise deviations.
    pub(crate) size: f64,
    /// Squared residual that the linear model loses.
    pub(crate) explained: f64,
    /// Of the causes' numbers.
    pub(crate) covariance: Option<Matrix>,
}

impl Part {
    pub(crate) fn new(
        context: &Context<'_>,
        problem: &BaseProblem<'_>,
        blocks: Blocks,
        matrix: Option<&Matrix>,
        free: &[usize],
    ) -> Result<Self, DiagnosisError> {
        let Some(matrix) = matrix.filter(|_| !free.is_empty()) else {
            return Ok(Self {
                free: Matrix::zeros(blocks.count(), 0),
                basis: None,
                blocks,
            });
        };
        let free = compress_matrix(context, problem, &blocks, matrix, free);
        let basis = Some(OrthonormalBasis::new(&free, RANK_TOLERANCE)?);
        Ok(Self {
            blocks,
            free,
            basis,
        })
    }

    pub(crate) fn step(
        &self,
        columns: &[Vec<f64>],
        target: &[f64],
    ) -> Result<Step, DiagnosisError> {
        let across = |vector: &[f64]| {
            let mut rest = vector.to_vec();
            if let Some(basis) = &self.basis {
                let directions = basis.directions();
                for _ in 0..2 {
                    for k in 0..directions.columns() {
                        take_off(&mut rest, directions.column(k));
                    }
                }
            }
            rest
        };
        let mut left = target.to_vec();
        let mut numbers = Vec::new();
        let mut covariance = None;
        if !columns.is_empty() {
            let projected: Vec<Vec<f64>> = columns.iter().map(|column| across(column)).collect();
            let matrix = Matrix::from_fn(target.len(), columns.len(), |row, column| {
                projected[column][row]
            });
            let reduction = Reduction::new(&matrix, target)?;
            let all: Vec<usize> = (0..columns.len()).collect();
            numbers = reduction.solve(&all, 0.0, RANK_TOLERANCE)?.values;
            covariance = reduction.covariance(&all, RANK_TOLERANCE).ok();
            for (column, number) in columns.iter().zip(&numbers) {
                for (entry, value) in left.iter_mut().zip(column) {
                    *entry -= number * value;
                }
            }
        }
        let mut values = match &self.basis {
            Some(basis) => basis.solve(&left)?,
            None => Vec::new(),
        };
        if !values.is_empty() {
            let moved = self.free.times(&values)?;
            for (entry, value) in left.iter_mut().zip(&moved) {
                *entry -= value;
            }
        }
        let moved: Vec<f64> = target.iter().zip(&left).map(|(a, b)| a - b).collect();
        values.extend(&numbers);
        Ok(Step {
            values,
            size: root_mean_square(&moved),
            explained: dot(target, target) - dot(&left, &left),
            covariance,
        })
    }
}

pub(crate) fn square(part: &Part, rows: &[Vec<f64>]) -> f64 {
    let whitened = compress_rows(&part.blocks, rows);
    dot(&whitened, &whitened)
}

pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

pub(crate) fn dense(part: &Part, signal: &Signal) -> Vec<f64> {
    let mut dense = vec![0.0; part.blocks.count()];
    for (stream, values) in &signal.parts {
        let compressed = part.blocks.compress(*stream, |row| values[row]);
        dense[part.blocks.range(*stream)].copy_from_slice(&compressed);
    }
    dense
}
