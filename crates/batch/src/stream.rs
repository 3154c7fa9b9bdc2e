//! A problem whose poses are read anew for every pass and never held.

use std::cell::RefCell;

use haptical_identification::{Form, IdentificationError, Matrix, Problem};
use haptical_kinematics::Motion;
use pulp::Arch;

use crate::aligned::Aligned;
use crate::blocks::{FoldTiles, TileRoom, merge_in_order};
use crate::poses::{Columns, TILE_ROWS, TILES_IN_BLOCK, fill_up, not_finite, weight_error};
use crate::program::Program;
use crate::sweep::Tile;
use crate::trigonometry::LARGEST_RAD;
use crate::{BatchError, DistanceModel, Sines, Triangle};

/// One pose with its measured distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseRow<'r> {
    /// Joint variables after transmissions, one per moving row (rad, or m).
    pub joints: &'r [f64],
    /// Measured distance in m.
    pub distance_m: f64,
    /// One over the distance's standard deviation, in 1/m.
    pub weight: f64,
}

/// Distances from a source that can be read again and again: `source` hands every pose in order to
/// the function that it is given, once per pass, and passes its error on. Memory is one tile and two
/// triangles, whatever the number of poses; the triangle is, bit for bit, that of a
/// [`crate::PoseBatch`] of the same poses with [`Sines::EachPass`].
///
/// ```
/// use haptical_batch::{BatchError, DistanceModel, PoseRow, StreamedDistance};
/// use haptical_identification::{Settings, solve};
/// use haptical_kinematics::{Convention, Link, Motion};
/// let links = [Link { a_m: 0.29, ..Link::default() }, Link { a_m: 0.21, ..Link::default() }];
/// let motions = [Motion::Fixed, Motion::Revolute];
/// let model = DistanceModel::new(Convention::Standard, &links, &motions, [0.0; 3])?;
/// let source = |each: &mut dyn FnMut(PoseRow<'_>) -> Result<(), BatchError>| {
///     for index in 0..1000 {
///         let q = 0.002 * f64::from(index);
///         let distance_m = (0.13 + 0.12 * q.cos()).sqrt();
///         each(PoseRow { joints: &[q], distance_m, weight: 1e4 })?;
///     }
///     Ok(())
/// };
/// let problem = StreamedDistance::new(&model, source);
/// let fit = solve(&problem, &model.start(), &[0, 4, 7], &Settings::default())?;
/// assert!((fit.parameters[0] - 0.3).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StreamedDistance<'m, F> {
    model: &'m DistanceModel,
    source: F,
    state: RefCell<State>,
}

impl<F> std::fmt::Debug for StreamedDistance<'_, F> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = formatter.debug_struct("StreamedDistance");
        shown.field("model", &self.model).finish_non_exhaustive()
    }
}

/// Room of a pass.
#[derive(Debug, Default)]
struct State {
    program: Program,
    room: TileRoom,
    data: Aligned,
    block: Triangle,
    total: Triangle,
}

impl<'m, F> StreamedDistance<'m, F>
where
    F: Fn(&mut dyn FnMut(PoseRow<'_>) -> Result<(), BatchError>) -> Result<(), BatchError>,
{
    /// A model and a source of poses of its chain.
    pub fn new(model: &'m DistanceModel, source: F) -> Self {
        Self {
            model,
            source,
            state: RefCell::default(),
        }
    }
}

/// A tile that is being filled.
struct Filling<'s> {
    columns: Columns,
    moving: usize,
    pose: usize,
    /// Rows of the tile, and tiles of the block.
    filled: usize,
    tiles: usize,
    fast: bool,
    /// Joint variables up to here leave room for the constant angles.
    largest_rad: f64,
    state: &'s mut State,
}

impl Filling<'_> {
    fn add(&mut self, row: PoseRow<'_>) -> Result<(), BatchError> {
        if row.joints.len() != self.moving {
            return Err(BatchError::Length {
                what: "joint variables of a pose",
                expected: self.moving,
                found: row.joints.len(),
            });
        }
        let named = [("the distance", row.distance_m), ("the weight", row.weight)];
        let variables = row.joints.iter().map(|&value| ("a joint variable", value));
        for (what, value) in variables.chain(named) {
            if !value.is_finite() {
                return Err(not_finite(what, self.pose, value));
            }
        }
        if row.weight < 0.0 {
            return Err(weight_error(self.pose, row.weight));
        }
        let data = self.state.data.as_mut_slice();
        let at = self.filled;
        for (&column, &value) in self.columns.joints.iter().zip(row.joints) {
            data[column * TILE_ROWS + at] = value;
            self.fast &= value.abs() <= self.largest_rad;
        }
        data[self.columns.distance * TILE_ROWS + at] = row.distance_m;
        data[self.columns.weight * TILE_ROWS + at] = row.weight;
        self.pose += 1;
        self.filled += 1;
        if self.filled == TILE_ROWS {
            self.fold()?;
        }
        Ok(())
    }

    fn fold(&mut self) -> Result<(), BatchError> {
        let State {
            program,
            room,
            data,
            block,
            total,
        } = &mut *self.state;
        let (rows, fast) = (self.filled, self.fast);
        if rows == 0 {
            return Ok(());
        }
        for column in data
            .as_mut_slice()
            .chunks_exact_mut(TILE_ROWS)
            .take(self.columns.distance)
        {
            fill_up(column, rows);
        }
        for column in [self.columns.distance, self.columns.weight] {
            data.as_mut_slice()[column * TILE_ROWS..][rows..TILE_ROWS].fill(0.0);
        }
        let (columns, data) = (&self.columns, data.as_slice());
        let tile = Tile {
            program,
            columns,
            data,
            rows,
            fast,
        };
        let tiles = std::iter::once((self.pose - rows, tile));
        Arch::new().dispatch(FoldTiles {
            tiles,
            room,
            triangle: block,
        })?;
        self.filled = 0;
        self.fast = true;
        self.tiles += 1;
        if self.tiles == TILES_IN_BLOCK {
            merge_in_order(total, block, room);
            block.clear(program.columns);
            self.tiles = 0;
        }
        Ok(())
    }

    fn finish(mut self) -> Result<(), BatchError> {
        self.fold()?;
        let State {
            room, block, total, ..
        } = &mut *self.state;
        if self.tiles > 0 {
            merge_in_order(total, block, room);
        }
        if total.rows() == 0 {
            return Err(BatchError::NoPose);
        }
        total.check()
    }
}

impl<F> Problem for StreamedDistance<'_, F>
where
    F: Fn(&mut dyn FnMut(PoseRow<'_>) -> Result<(), BatchError>) -> Result<(), BatchError>,
{
    fn parameter_count(&self) -> usize {
        self.model.parameters.len()
    }

    fn residual_count(&self) -> usize {
        self.model.parameters.len() + 1
    }

    fn form(&self) -> Form {
        Form::Triangle
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let (free, matrix) = match jacobian {
            Some((free, matrix)) => (free, Some(matrix)),
            None => (&[][..], None),
        };
        // taken out: a source may ask this very problem something
        let mut taken = self.state.take();
        let state = &mut taken;
        state.program.prepare(self.model, parameters, free);
        state.room.reserve(&state.program);
        state.block.clear(free.len());
        state.total.clear(free.len());
        let motions = &self.model.motions;
        let columns = Columns::new(motions, Sines::EachPass);
        state.data.reserve(columns.count * TILE_ROWS);
        let mut filling = Filling {
            moving: motions
                .iter()
                .filter(|motion| **motion != Motion::Fixed)
                .count(),
            fast: true,
            largest_rad: LARGEST_RAD - state.program.largest_constant_rad(),
            columns,
            pose: 0,
            filled: 0,
            tiles: 0,
            state,
        };
        (self.source)(&mut |row| filling.add(row))?;
        filling.finish()?;
        taken.total.write_into(residuals, matrix);
        self.state.replace(taken);
        Ok(())
    }
}
