//! A batch as a least-squares problem: row by row, or reduced to a triangle in the same pass.

use std::cell::RefCell;

use haptical_identification::{IdentificationError, Matrix, Problem, TriangleProblem};
use haptical_linalg::{TILE_ROWS, Triangle};

use crate::blocks::{Blocks, visit_tiles};
use crate::program::Program;
use crate::{BatchError, DistanceModel, PoseBatch, Threads};

/// The distances of a batch as weighted residuals, one row per pose: model minus measurement times the
/// weight, as functions of the model's parameters (Baser & Konukseven eqs. (5) and (6)).
#[derive(Debug)]
pub struct DistanceProblem<'a> {
    model: &'a DistanceModel,
    poses: &'a PoseBatch,
    /// Room, kept from call to call.
    program: RefCell<Program>,
}

impl<'a> DistanceProblem<'a> {
    /// Joins a model and the poses of its chain.
    ///
    /// # Errors
    /// [`BatchError::Length`] where the rows of the two do not move alike.
    pub fn new(model: &'a DistanceModel, poses: &'a PoseBatch) -> Result<Self, BatchError> {
        poses.check(model)?;
        let program = RefCell::default();
        Ok(Self {
            model,
            poses,
            program,
        })
    }

    /// Hands residuals and derivatives with respect to `free` to `visit`, some poses at a time and in
    /// order, without holding them all.
    ///
    /// # Errors
    /// As [`ReducedDistance::reduce`]; poses before the one that is refused have been visited.
    pub fn visit(
        &self,
        parameters: &[f64],
        free: &[usize],
        mut visit: impl FnMut(&TileRows<'_>),
    ) -> Result<(), BatchError> {
        check_lengths(self.model, parameters, free)?;
        let mut program = self.program.take();
        program.prepare(self.model, parameters, free);
        let visited = visit_tiles(
            self.poses,
            &program,
            !free.is_empty(),
            |first_pose, rows, tile| {
                let columns = free.len();
                visit(&TileRows {
                    first_pose,
                    rows,
                    columns,
                    tile,
                });
            },
        );
        self.program.replace(program);
        visited
    }
}

/// Residuals and derivatives of some poses, as [`DistanceProblem::visit`] hands them over.
#[derive(Debug, Clone, Copy)]
pub struct TileRows<'t> {
    first_pose: usize,
    rows: usize,
    columns: usize,
    tile: &'t [f64],
}

impl<'t> TileRows<'t> {
    /// Index of the first of these poses.
    pub fn first_pose(&self) -> usize {
        self.first_pose
    }

    /// Weighted residuals, one for each pose.
    pub fn residuals(&self) -> &'t [f64] {
        &self.tile[self.columns * TILE_ROWS..][..self.rows]
    }

    /// Their derivatives with respect to one free parameter after the other.
    pub fn derivatives(&self) -> impl Iterator<Item = &'t [f64]> {
        let (rows, columns) = (self.rows, self.columns);
        let tile = self.tile.chunks_exact(TILE_ROWS).take(columns);
        tile.map(move |column| &column[..rows])
    }
}

/// The vector must be the model's, and so must the indices.
fn check_lengths(
    model: &DistanceModel,
    parameters: &[f64],
    free: &[usize],
) -> Result<(), BatchError> {
    let expected = model.parameters.len();
    if parameters.len() != expected {
        return Err(BatchError::Length {
            what: "the parameter vector",
            expected,
            found: parameters.len(),
        });
    }
    if let Some(&index) = free.iter().find(|index| **index >= expected) {
        return Err(BatchError::Length {
            what: "the parameter vector, by the index of a free parameter",
            expected: index + 1,
            found: expected,
        });
    }
    Ok(())
}

impl Problem for DistanceProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.model.parameters.len()
    }

    fn residual_count(&self) -> usize {
        self.poses.len()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let free = jacobian.as_ref().map_or(&[][..], |(free, _)| free);
        self.visit(parameters, free, |tile| {
            let poses = tile.first_pose..tile.first_pose + tile.rows;
            residuals[poses.clone()].copy_from_slice(tile.residuals());
            if let Some((_, matrix)) = &mut jacobian {
                for (column, derivatives) in tile.derivatives().enumerate() {
                    matrix.column_mut(column)[poses.clone()].copy_from_slice(derivatives);
                }
            }
        })?;
        Ok(())
    }
}

/// Room that passes of a [`ReducedDistance`] work in.
#[derive(Debug, Default)]
pub struct PassRoom(Blocks);

/// The same problem, reduced on the way to a [`Triangle`]: its residuals are (q, sqrt(rest), 0, ...), as many as
/// parameters and one more. One pass gives cost and triangle, so a search makes no other for the cost of a trial.
///
/// [`Problem::residual_count`] counts the triangle's rows: degrees of freedom follow from
/// [`ReducedDistance::pose_count`].
#[derive(Debug)]
pub struct ReducedDistance<'a> {
    model: &'a DistanceModel,
    poses: &'a PoseBatch,
    every: usize,
    threads: Threads,
    blocks: RefCell<Blocks>,
}

impl<'a> ReducedDistance<'a> {
    /// Joins a model and the poses of its chain.
    ///
    /// # Errors
    /// As [`DistanceProblem::new`].
    pub fn new(
        model: &'a DistanceModel,
        poses: &'a PoseBatch,
        threads: Threads,
    ) -> Result<Self, BatchError> {
        poses.check(model)?;
        Ok(Self {
            model,
            poses,
            every: 1,
            threads,
            blocks: RefCell::default(),
        })
    }

    /// The problem of every `every`-th block of 4096 poses alone; 0 counts as 1.
    #[must_use]
    pub fn with_every(mut self, every: usize) -> Self {
        self.every = every.max(1);
        self
    }

    /// The same with the room of earlier passes, which then allocate nothing.
    #[must_use]
    pub fn with_room(mut self, room: PassRoom) -> Self {
        self.blocks = RefCell::new(room.0);
        self
    }

    /// The room of its passes.
    pub fn into_room(self) -> PassRoom {
        PassRoom(self.blocks.into_inner())
    }

    /// Poses of the blocks that count.
    pub fn pose_count(&self) -> usize {
        self.poses.count_every(self.every)
    }

    /// One pass: residuals and derivatives of all poses at `parameters` with respect to `free`, reduced
    /// to a triangle, which is handed to `use_it`.
    ///
    /// # Errors
    /// [`BatchError::Length`] for a vector that does not fit the model, [`BatchError::ZeroDistance`],
    /// [`BatchError::OutOfRange`], [`BatchError::Overflow`].
    pub fn reduce<T>(
        &self,
        parameters: &[f64],
        free: &[usize],
        use_it: impl FnOnce(&Triangle) -> T,
    ) -> Result<T, BatchError> {
        check_lengths(self.model, parameters, free)?;
        // taken out: `use_it` may ask for another pass
        let mut blocks = self.blocks.take();
        blocks.program.prepare(self.model, parameters, free);
        let passed = blocks.pass(self.poses, self.every, self.threads);
        let used = passed.map(|()| use_it(&blocks.total));
        self.blocks.replace(blocks);
        used
    }
}

impl TriangleProblem for ReducedDistance<'_> {
    fn columns(&self) -> usize {
        self.model.parameters.len()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        Ok(self.reduce(parameters, free, |triangle| into.copy_from(triangle))?)
    }
}
