//! Rows that a fit sees, and one Gauss-Newton step on them.

use haptical_effects::{Context, Signal};
use haptical_identification::{Matrix, Reduction};
use haptical_linalg::{Direction, OrthonormalBasis, RANK_TOLERANCE, SparseColumns};

use crate::DiagnosisError;
use crate::engine::base::Base;
use crate::engine::base::problem::{BaseProblem, Derivatives};
use crate::engine::blocks::Blocks;
use crate::engine::system::{System, compress_columns, compress_rows, dot, oscillations, windows};

/// Rows that a fit sees: their blocks, and the base model's derivatives on them.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) blocks: Blocks,
    /// Compressed derivatives of the free parameters.
    pub(crate) free: SparseColumns,
    /// Their decomposition, one row for each anchored parameter below them; none without parameters.
    basis: Option<OrthonormalBasis>,
    /// One over the standard deviations of the anchored parameters; empty where none is anchored.
    stiffness: Vec<f64>,
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
        derivatives: Option<&Derivatives>,
        base: &Base,
    ) -> Result<Self, DiagnosisError> {
        let Some(derivatives) = derivatives.filter(|_| !base.free.is_empty()) else {
            return Ok(Self {
                free: SparseColumns::new(blocks.count(), Vec::new()),
                basis: None,
                blocks,
                stiffness: Vec::new(),
            });
        };
        let free = compress_columns(context, problem, &blocks, derivatives, &base.free);
        let stiffness = base.stiffness().to_vec();
        let rows = free.rows();
        let anchored = (!stiffness.is_empty()).then(|| {
            let lengthened = stiffness.iter().enumerate().map(|(column, stiffness)| {
                let mut entries = free.dense(column);
                entries.resize(rows + free.columns(), 0.0);
                entries[rows + column] = *stiffness;
                Direction::new(entries)
            });
            SparseColumns::new(rows + stiffness.len(), lengthened.collect())
        });
        let whole = anchored.as_ref().unwrap_or(&free);
        let basis = Some(OrthonormalBasis::new(whole, RANK_TOLERANCE)?);
        Ok(Self {
            blocks,
            free,
            basis,
            stiffness,
        })
    }

    /// Orthonormal directions of the free parameters, whatever anchors them.
    fn directions(&self) -> Result<Vec<Direction>, DiagnosisError> {
        let columns = |basis: &OrthonormalBasis| basis.directions().cloned().collect();
        Ok(match &self.basis {
            None => Vec::new(),
            Some(basis) if self.stiffness.is_empty() => columns(basis),
            Some(_) => columns(&OrthonormalBasis::new(&self.free, RANK_TOLERANCE)?),
        })
    }

    /// The system of the free parameters' directions, and of what `other` parameters, held in the fit, could still do.
    pub(crate) fn system(
        &self,
        context: &Context<'_>,
        other: Option<&SparseColumns>,
        residual: &[Vec<f64>],
    ) -> Result<System, DiagnosisError> {
        let windows = windows(context, &self.blocks);
        let reading = vec![0.0; self.blocks.count()];
        let mut system = System::bare(self.blocks.clone(), windows, reading);
        system.basis = self.directions()?;
        system.oscillations = oscillations(context, &self.blocks);
        let columns = other.map_or(0, SparseColumns::columns);
        for column in (0..columns).filter_map(|k| Some(other?.dense(k))) {
            system.take(column);
        }
        system.set_residual(residual);
        Ok(system)
    }

    /// The step of the base model alone, with the pull of its anchors, and the fall of the cost that it promises; none without
    /// parameters.
    pub(crate) fn base_step(
        &self,
        residual: &[Vec<f64>],
        pull: &[f64],
    ) -> Result<Option<(Vec<f64>, f64)>, DiagnosisError> {
        let Some(basis) = &self.basis else {
            return Ok(None);
        };
        let mut target = compress_rows(&self.blocks, residual);
        target.extend_from_slice(pull);
        let along = basis
            .directions()
            .map(|direction| direction.dot(&target).powi(2));
        let promised = along.sum();
        Ok(Some((basis.solve(&target)?, promised)))
    }

    /// A step with the pull of the anchors, empty where there are none.
    pub(crate) fn step(
        &self,
        columns: &[Vec<f64>],
        residual: &[Vec<f64>],
        pull: &[f64],
    ) -> Result<Step, DiagnosisError> {
        let mut target = compress_rows(&self.blocks, residual);
        target.extend_from_slice(pull);
        let target = target.as_slice();
        let lengthened = |column: &Vec<f64>| {
            let mut column = column.clone();
            column.resize(target.len(), 0.0);
            column
        };
        let columns: Vec<Vec<f64>> = columns.iter().map(lengthened).collect();
        let columns = columns.as_slice();
        let mut left = target.to_vec();
        let mut numbers = Vec::new();
        let mut covariance = None;
        if !columns.is_empty() {
            let projected: Vec<Vec<f64>> = (columns.iter())
                .map(|column| across(self.basis.as_ref(), column))
                .collect();
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
            let mut moved = self.free.times(&values)?;
            let anchored = self.stiffness.iter().zip(&values);
            moved.extend(anchored.map(|(stiffness, value)| stiffness * value));
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

/// Squared residuals of a part's rows, and of the anchors.
pub(crate) fn square(part: &Part, rows: &[Vec<f64>], pull: &[f64]) -> f64 {
    let whitened = compress_rows(&part.blocks, rows);
    dot(&whitened, &whitened) + dot(pull, pull)
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

/// The part of a vector across a basis.
pub(crate) fn across(basis: Option<&OrthonormalBasis>, vector: &[f64]) -> Vec<f64> {
    let mut rest = vector.to_vec();
    for _ in 0..2 {
        for direction in basis.iter().flat_map(|basis| basis.directions()) {
            direction.take_off(&mut rest);
        }
    }
    rest
}
