//! Rows that a fit sees, and one Gauss-Newton step on them.

use haptical_effects::Context;
use haptical_linalg::{Direction, OrthonormalBasis, RANK_TOLERANCE, SparseColumns};

use crate::Result;
use crate::engine::{Blocks, System, dot, oscillations, windows};

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

impl Part {
    /// The rows of blocks with the derivatives of the free parameters on them, none without such, and one over the deviations of
    /// their anchors.
    pub(super) fn new(
        blocks: Blocks,
        free: Option<SparseColumns>,
        stiffness: &[f64],
    ) -> Result<Self> {
        let Some(free) = free else {
            return Ok(Self {
                free: SparseColumns::new(blocks.count(), Vec::new()),
                basis: None,
                blocks,
                stiffness: Vec::new(),
            });
        };
        let stiffness = stiffness.to_vec();
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
    fn directions(&self) -> Result<Vec<Direction>> {
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
    ) -> Result<System> {
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
    ) -> Result<Option<(Vec<f64>, f64)>> {
        let Some(basis) = &self.basis else {
            return Ok(None);
        };
        let mut target = self.blocks.compress_rows(residual);
        target.extend_from_slice(pull);
        let along = basis
            .directions()
            .map(|direction| direction.dot(&target).powi(2));
        let promised = along.sum();
        Ok(Some((basis.solve(&target)?, promised)))
    }
}

/// Squared residuals of a part's rows, and of the anchors.
pub(crate) fn square(part: &Part, rows: &[Vec<f64>], pull: &[f64]) -> f64 {
    let whitened = part.blocks.compress_rows(rows);
    dot(&whitened, &whitened) + dot(pull, pull)
}

pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}
