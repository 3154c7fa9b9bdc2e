//! One pass over a batch: blocks of tiles, each reduced to a triangle, and the triangles merged in order.

use std::cell::RefCell;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::poses::TILES_IN_BLOCK;
use crate::program::Program;
use crate::sweep::{BadRow, SweepRoom, Tile, sweep_tile};
use crate::{BatchError, PoseBatch, Triangle};
use haptical_linalg::{Aligned, TILE_ROWS};

/// Whether a pass may use several threads: those of the rayon pool it is called in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Threads {
    /// Where there are enough blocks to be worth it; the bits are the same.
    #[default]
    Several,
    /// Never.
    One,
}

/// Blocks from which several threads are faster than one (README.md has the measurement).
const BLOCKS_FOR_THREADS: usize = 2;

/// Room for one tile.
#[derive(Debug, Default)]
pub(crate) struct TileRoom {
    pub(crate) sweep: SweepRoom,
    /// Columns of derivatives, then the residuals.
    pub(crate) tile: Aligned,
}

impl TileRoom {
    pub(crate) fn reserve(&mut self, program: &Program) {
        self.sweep.reserve(program);
        self.tile.reserve((program.columns + 1) * TILE_ROWS);
    }
}

thread_local! {
    /// One for each thread, kept from pass to pass, so that a pass allocates nothing.
    static ROOM: RefCell<TileRoom> = RefCell::default();
}

/// Sweeps tiles and folds them.
struct FoldTiles<'a, T> {
    pub(crate) tiles: T,
    pub(crate) room: &'a mut TileRoom,
    pub(crate) triangle: &'a mut Triangle,
}

impl<'t, T: Iterator<Item = (usize, Tile<'t>)>> WithSimd for FoldTiles<'_, T> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Result<(), BatchError> {
        let Self {
            tiles,
            room,
            triangle,
        } = self;
        for (first_pose, tile) in tiles {
            let columns = tile.program.columns;
            let all = room.tile.as_mut_slice();
            let (derivatives, residuals) = all.split_at_mut(columns * TILE_ROWS);
            sweep_tile(simd, &tile, &mut room.sweep, residuals, Some(derivatives))
                .map_err(|bad| refused(first_pose, bad))?;
            triangle.fold_tile_with(simd, all, tile.rows);
        }
        Ok(())
    }
}

fn refused(first_pose: usize, bad: BadRow) -> BatchError {
    let pose = first_pose + bad.row;
    if bad.is_zero {
        BatchError::ZeroDistance { pose }
    } else {
        BatchError::OutOfRange { pose }
    }
}

/// The triangles of a batch's blocks, and their merger.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) program: Program,
    blocks: Vec<Triangle>,
    pub(crate) total: Triangle,
}

impl Blocks {
    /// Reduces every `every`-th block of a batch with the prepared program.
    pub(crate) fn pass(
        &mut self,
        poses: &PoseBatch,
        every: usize,
        threads: Threads,
    ) -> Result<(), BatchError> {
        let Self {
            program,
            blocks,
            total,
        } = self;
        let program = &*program;
        let fast = program.is_within(poses);
        let count = poses.blocks().div_ceil(every);
        blocks.resize_with(count, Triangle::default);
        let work = |(index, triangle): (usize, &mut Triangle)| {
            ROOM.with_borrow_mut(|room| block(poses, program, fast, index * every, room, triangle))
        };
        if threads == Threads::Several
            && count >= BLOCKS_FOR_THREADS
            && rayon::current_num_threads() > 1
        {
            // the first failing block in order, whichever thread came first
            let failure = blocks
                .par_iter_mut()
                .enumerate()
                .filter_map(|pair| work(pair).err())
                .min_by_key(place);
            failure.map_or(Ok(()), Err)?;
        } else {
            blocks.iter_mut().enumerate().try_for_each(work)?;
        }
        let Some((first, others)) = blocks.split_first_mut() else {
            return Err(BatchError::NoPose);
        };
        // the first one is the total; the room goes to and fro
        total.reserve(program.columns);
        std::mem::swap(total, first);
        if !others.is_empty() {
            ROOM.with_borrow_mut(|room| {
                room.reserve(program);
                for block in others {
                    total.merge(block, room.tile.as_mut_slice());
                }
            });
        }
        total.check().map_err(|_| BatchError::Overflow)
    }
}

/// Poses in order; what is not of a pose comes last.
fn place(error: &BatchError) -> usize {
    match error {
        BatchError::ZeroDistance { pose } | BatchError::OutOfRange { pose } => *pose,
        _ => usize::MAX,
    }
}

fn block(
    poses: &PoseBatch,
    program: &Program,
    fast: bool,
    block: usize,
    room: &mut TileRoom,
    triangle: &mut Triangle,
) -> Result<(), BatchError> {
    room.reserve(program);
    triangle.clear(program.columns);
    let first = block * TILES_IN_BLOCK;
    let last = (first + TILES_IN_BLOCK).min(poses.tiles());
    let tiles = (first..last).map(|index| {
        let (data, rows) = poses.tile(index);
        let columns = &poses.columns;
        (
            index * TILE_ROWS,
            Tile {
                program,
                columns,
                data,
                rows,
                fast,
            },
        )
    });
    Arch::new().dispatch(FoldTiles {
        tiles,
        room,
        triangle,
    })
}

/// Sweeps every tile of a batch without folding it.
struct SweepTiles<'a, F> {
    poses: &'a PoseBatch,
    program: &'a Program,
    fast: bool,
    room: &'a mut TileRoom,
    with_derivatives: bool,
    visit: F,
}

impl<F: FnMut(usize, usize, &[f64])> WithSimd for SweepTiles<'_, F> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Result<(), BatchError> {
        for index in 0..self.poses.tiles() {
            let (data, rows) = self.poses.tile(index);
            let (program, fast) = (self.program, self.fast);
            let tile = Tile {
                program,
                columns: &self.poses.columns,
                data,
                rows,
                fast,
            };
            let columns = program.columns;
            let all = self.room.tile.as_mut_slice();
            let (derivatives, residuals) = all.split_at_mut(columns * TILE_ROWS);
            let derivatives = self.with_derivatives.then_some(derivatives);
            sweep_tile(simd, &tile, &mut self.room.sweep, residuals, derivatives)
                .map_err(|bad| refused(index * TILE_ROWS, bad))?;
            (self.visit)(index * TILE_ROWS, rows, self.room.tile.as_slice());
        }
        Ok(())
    }
}

/// Hands every tile's columns of derivatives and its residuals to `visit`, with its first pose and its
/// number of poses.
pub(crate) fn visit_tiles(
    poses: &PoseBatch,
    program: &Program,
    with_derivatives: bool,
    visit: impl FnMut(usize, usize, &[f64]),
) -> Result<(), BatchError> {
    let fast = program.is_within(poses);
    // taken out: `visit` may ask for another pass
    let mut room = ROOM.take();
    room.reserve(program);
    let visited = Arch::new().dispatch(SweepTiles {
        poses,
        program,
        fast,
        room: &mut room,
        with_derivatives,
        visit,
    });
    ROOM.replace(room);
    visited
}

#[cfg(test)]
mod tests {
    //! Lanes of one number: what a processor without vectors does, which no test here would meet.

    use haptical_kinematics::{Convention, Link, Motion};
    use pulp::{Scalar, Simd};

    use super::*;
    use crate::{DistanceModel, Sines};

    #[test]
    fn scalars_and_lanes_agree() {
        let motions = [Motion::Fixed, Motion::Revolute, Motion::Revolute];
        let link = Link {
            a_m: 0.3,
            alpha_rad: 0.7,
            d_m: 0.2,
            theta_rad: -0.4,
            beta_rad: 0.1,
            b_m: 0.05,
        };
        let model = DistanceModel::new(Convention::Standard, &[link; 3], &motions, [0.1, 0.0, 2.0]);
        let model = model.unwrap();
        let joints: [Vec<f64>; 2] =
            [0.37, 0.73].map(|step| (0..300).map(|pose| f64::from(pose) * step).collect());
        let (distances_m, weights) = (vec![1.5; 300], vec![100.0; 300]);
        for sines in [Sines::Cached, Sines::EachPass] {
            let poses = PoseBatch::new(&motions, &joints, &distances_m, &weights, sines).unwrap();
            let free = [8, 4, 5, 7, 0];
            let mut blocks = Blocks::default();
            blocks.program.prepare(&model, &model.start(), &free);
            blocks.pass(&poses, 1, Threads::One).unwrap();
            let mut room = TileRoom::default();
            room.reserve(&blocks.program);
            let mut triangle = Triangle::new(free.len());
            let program = &blocks.program;
            let tiles = (0..poses.tiles()).map(|index| {
                let ((data, rows), columns) = (poses.tile(index), &poses.columns);
                let tile = Tile {
                    program,
                    columns,
                    data,
                    rows,
                    fast: true,
                };
                (index * TILE_ROWS, tile)
            });
            let (room, into) = (&mut room, &mut triangle);
            let fold = FoldTiles {
                tiles,
                room,
                triangle: into,
            };
            Simd::vectorize(Scalar, fold).unwrap();
            assert!((triangle.cost() / blocks.total.cost() - 1.0).abs() < 1e-13);
            for column in 0..free.len() {
                let size = blocks.total.entry(column, column).abs().max(1.0);
                for row in 0..=column {
                    let lanes = blocks.total.entry(row, column);
                    let difference = triangle.entry(row, column) - lanes;
                    assert!(
                        difference.abs() < 1e-9 * size,
                        "{row} {column}: {difference:e}"
                    );
                }
            }
        }
    }
}
