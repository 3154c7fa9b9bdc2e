//! Weighted residuals of a batch and their derivatives, some poses at a time.

use std::cell::RefCell;

use haptical_linalg::{Aligned, TILE_ROWS};
use pulp::{Arch, Simd, WithSimd};

use crate::error::check_length;
use crate::program::Program;
use crate::sweep::{BadRow, SweepRoom, Tile, sweep_tile};
use crate::{BatchError, DistanceModel, PoseBatch};

/// Residuals and derivatives of some poses, as [`PoseBatch::visit`] hands them over.
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

impl PoseBatch {
    /// Works out the distances of the poses as weighted residuals, one row per pose: model minus measurement
    /// times the weight, at `parameters` of the model (Baser & Konukseven eqs. (5) and (6)). Residuals and their
    /// derivatives with respect to the parameters `free` are handed to `visit`, some poses at a time and in
    /// order, without holding them all.
    ///
    /// ```
    /// use haptical_batch::{DistanceModel, PoseBatch};
    /// use haptical_kinematics::{Convention, Link, Motion};
    /// // one link of 0.3 m whose anchor is at (0.1, 0, 0) m, straight ahead: 0.2 m, measured as 0.21 m
    /// let link = Link { a_m: 0.3, ..Link::default() };
    /// let model = DistanceModel::new(Convention::Standard, &[link], &[Motion::Revolute], [0.1, 0.0, 0.0])?;
    /// let poses = PoseBatch::new(&[Motion::Revolute], &[[0.0]], &[0.21], &[1e3])?;
    /// poses.visit(&model, &model.start(), &[0], |rows| {
    ///     assert!((rows.residuals()[0] + 10.0).abs() < 1e-9);
    ///     assert!(rows.derivatives().all(|along| (along[0] - 1e3).abs() < 1e-9)); // d delta / d a = 1
    /// })?;
    /// # Ok::<(), haptical_batch::BatchError>(())
    /// ```
    ///
    /// # Errors
    /// [`BatchError::Length`] for a vector that does not fit the model, or rows that do not move as the model's;
    /// [`BatchError::ZeroDistance`], [`BatchError::OutOfRange`]: poses before the one that is refused have been
    /// visited.
    pub fn visit(
        &self,
        model: &DistanceModel,
        parameters: &[f64],
        free: &[usize],
        visit: impl FnMut(&TileRows<'_>),
    ) -> Result<(), BatchError> {
        self.check(model)?;
        check_lengths(model, parameters, free)?;
        // taken out: `visit` may ask for another pass
        let mut room = ROOM.take();
        room.reserve(model, parameters, free);
        let poses = self;
        let visited = Arch::new().dispatch(SweepTiles {
            poses,
            room: &mut room,
            visit,
        });
        ROOM.replace(room);
        visited
    }
}

/// Room for one tile, and the model's program.
#[derive(Debug, Default)]
struct Room {
    program: Program,
    sweep: SweepRoom,
    /// Columns of derivatives, then the residuals.
    tile: Aligned,
}

impl Room {
    fn reserve(&mut self, model: &DistanceModel, parameters: &[f64], free: &[usize]) {
        self.program.prepare(model, parameters, free);
        self.sweep.reserve(&self.program);
        self.tile.reserve((self.program.columns + 1) * TILE_ROWS);
    }
}

thread_local! {
    /// One for each thread, kept from pass to pass, so that a pass allocates nothing.
    static ROOM: RefCell<Room> = RefCell::default();
}

/// Sweeps every tile of a batch.
struct SweepTiles<'a, F> {
    poses: &'a PoseBatch,
    room: &'a mut Room,
    visit: F,
}

impl<F: FnMut(&TileRows<'_>)> WithSimd for SweepTiles<'_, F> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Result<(), BatchError> {
        let Room {
            program,
            sweep,
            tile: all,
        } = self.room;
        let columns = program.columns;
        for index in 0..self.poses.tiles() {
            let (data, rows) = self.poses.tile(index);
            let first_pose = index * TILE_ROWS;
            let tile = Tile {
                program,
                columns: &self.poses.columns,
                data,
                rows,
            };
            let (derivatives, residuals) = all.as_mut_slice().split_at_mut(columns * TILE_ROWS);
            let derivatives = (columns > 0).then_some(derivatives);
            sweep_tile(simd, &tile, sweep, residuals, derivatives)
                .map_err(|bad| refused(first_pose, bad))?;
            (self.visit)(&TileRows {
                first_pose,
                rows,
                columns,
                tile: all.as_slice(),
            });
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

/// The vector must be the model's, and so must the indices.
fn check_lengths(
    model: &DistanceModel,
    parameters: &[f64],
    free: &[usize],
) -> Result<(), BatchError> {
    let expected = model.parameters.len();
    check_length("the parameter vector", expected, parameters.len())?;
    match free.iter().find(|index| **index >= expected) {
        None => Ok(()),
        Some(index) => check_length(
            "the parameter vector, by the index of a free parameter",
            index + 1,
            expected,
        ),
    }
}

#[cfg(test)]
mod tests {
    //! Lanes of one number: what a processor without vectors does, which no test here would meet.

    use haptical_kinematics::{Convention, Link, Motion};
    use pulp::{Scalar, Simd};

    use super::*;

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
        let poses = PoseBatch::new(&motions, &joints, &[1.5; 300], &[100.0; 300]).unwrap();
        let (start, free) = (model.start(), [8, 4, 5, 7, 0]);
        let numbers = |tile: &TileRows<'_>| -> Vec<f64> {
            let all = tile.derivatives().chain([tile.residuals()]);
            all.flatten().copied().collect()
        };
        let (mut lanes, mut scalars) = (Vec::new(), Vec::new());
        let visited = poses.visit(&model, &start, &free, |tile| lanes.extend(numbers(tile)));
        visited.unwrap();
        let mut room = Room::default();
        room.reserve(&model, &start, &free);
        let sweep = SweepTiles {
            poses: &poses,
            room: &mut room,
            visit: |tile: &TileRows<'_>| scalars.extend(numbers(tile)),
        };
        Simd::vectorize(Scalar, sweep).unwrap();
        assert_eq!(lanes.len(), 300 * 6);
        for (lane, scalar) in lanes.iter().zip(&scalars) {
            // distances of 2 m, weighed with 100
            assert!((lane - scalar).abs() < 1e-12, "{lane} {scalar}");
        }
    }
}
