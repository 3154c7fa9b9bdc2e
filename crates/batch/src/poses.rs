//! The poses of a batch, tile by tile in columns.

use haptical_kinematics::Motion;

use crate::error::check_length;
use crate::{BatchError, DistanceModel, sines_cosines};
use haptical_linalg::{Aligned, TILE_ROWS};

/// Joint variables (after transmissions), measured distances and weights of many poses, as columns of
/// tiles.
///
/// ```
/// use haptical_batch::PoseBatch;
/// use haptical_kinematics::Motion;
/// let joints = [vec![0.1, 0.2, 0.3]];
/// let poses = PoseBatch::new(&[Motion::Fixed, Motion::Revolute], &joints, &[0.5; 3], &[1e4; 3])?;
/// assert_eq!(poses.len(), 3);
/// # Ok::<(), haptical_batch::BatchError>(())
/// ```
#[derive(Debug)]
pub struct PoseBatch {
    motions: Vec<Motion>,
    pub(crate) columns: Columns,
    rows: usize,
    data: Aligned,
}

/// Places of the columns of a tile.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// First column of each joint: its sine, then its cosine, or the variable of a slide alone. Sines and cosines
    /// are worked out once: a pass turns them by the parameter's angle (sin(q + t) = sin q cos t + cos q sin t),
    /// always from the first values, so that no error gathers.
    pub(crate) joints: Vec<usize>,
    pub(crate) distance: usize,
    pub(crate) weight: usize,
    pub(crate) count: usize,
}

impl Columns {
    pub(crate) fn new(motions: &[Motion]) -> Self {
        let mut count = 0;
        let moving = motions.iter().filter(|motion| **motion != Motion::Fixed);
        let joints = moving
            .map(|motion| {
                let first = count;
                count += if *motion == Motion::Revolute { 2 } else { 1 };
                first
            })
            .collect();
        Self {
            joints,
            distance: count,
            weight: count + 1,
            count: count + 2,
        }
    }

    /// Whether a joint has columns for sine and cosine, not one for its variable.
    fn has_sines(&self, joint: usize) -> bool {
        let next = self.joints.get(joint + 1).unwrap_or(&self.distance);
        next - self.joints[joint] == 2
    }
}

impl PoseBatch {
    /// Poses of a chain with these motions: one slice per moving row with one joint variable per pose
    /// (rad, or m for a prismatic joint), and per pose a distance in m and a weight, one over the
    /// distance's standard deviation in 1/m.
    ///
    /// # Errors
    /// [`BatchError::NoPose`], [`BatchError::Length`]; [`BatchError::Pose`] for a number that is not
    /// finite or a weight that is negative.
    pub fn new<J: AsRef<[f64]>>(
        motions: &[Motion],
        joints: &[J],
        distances_m: &[f64],
        weights: &[f64],
    ) -> Result<Self, BatchError> {
        let rows = distances_m.len();
        let moving = motions.iter().filter(|motion| **motion != Motion::Fixed);
        let moving = moving.count();
        if rows == 0 {
            return Err(BatchError::NoPose);
        }
        check_length("joint variables' slices", moving, joints.len())?;
        for joint in joints {
            check_length("a joint's variables", rows, joint.as_ref().len())?;
            check_all("a joint variable", joint.as_ref())?;
        }
        check_length("weights", rows, weights.len())?;
        check_all("the distance", distances_m)?;
        check_all("the weight", weights)?;
        if let Some(pose) = weights.iter().position(|weight| *weight < 0.0) {
            return Err(weight_error(pose, weights[pose]));
        }
        let columns = Columns::new(motions);
        let tiles = rows.div_ceil(TILE_ROWS);
        let mut batch = Self {
            motions: motions.to_vec(),
            rows,
            data: Aligned::zeros(tiles * columns.count * TILE_ROWS),
            columns,
        };
        for (joint, variables) in joints.iter().enumerate() {
            batch.write_joint(joint, variables.as_ref());
        }
        for tile in 0..tiles {
            let first = tile * TILE_ROWS;
            let last = (first + TILE_ROWS).min(rows);
            let (count, at) = (batch.columns.count, &batch.columns);
            let into = &mut batch.data.as_mut_slice()[tile * count * TILE_ROWS..];
            into[at.distance * TILE_ROWS..][..last - first]
                .copy_from_slice(&distances_m[first..last]);
            // the weights of rows that fill up the tile stay 0
            into[at.weight * TILE_ROWS..][..last - first].copy_from_slice(&weights[first..last]);
        }
        Ok(batch)
    }

    /// The same poses with other variables of one joint (from 0, in rad or m): for angles that change from pass
    /// to pass, without anything else being worked out again.
    ///
    /// ```
    /// use haptical_batch::PoseBatch;
    /// use haptical_kinematics::Motion;
    /// let motions = [Motion::Fixed, Motion::Revolute];
    /// let mut poses = PoseBatch::new(&motions, &[[0.1, 0.2]], &[0.5; 2], &[1e4; 2])?;
    /// poses.move_joint(0, &[0.3, 0.4])?;
    /// assert!(poses.move_joint(1, &[0.3, 0.4]).is_err() && poses.move_joint(0, &[0.3]).is_err());
    /// # Ok::<(), haptical_batch::BatchError>(())
    /// ```
    ///
    /// # Errors
    /// [`BatchError::Length`] for a joint that the chain has not or another number of poses;
    /// [`BatchError::Pose`] for a number that is not finite.
    pub fn move_joint(&mut self, joint: usize, variables: &[f64]) -> Result<(), BatchError> {
        let count = self.columns.joints.len();
        if joint >= count {
            check_length("joints, by the index of one", count, joint + 1)?;
        }
        check_length("a joint's variables", self.rows, variables.len())?;
        check_all("a joint variable", variables)?;
        self.write_joint(joint, variables);
        Ok(())
    }

    /// Writes the columns of a joint into all tiles.
    fn write_joint(&mut self, joint: usize, variables: &[f64]) {
        let (count, first) = (self.columns.count, self.columns.joints[joint]);
        let has_sines = self.columns.has_sines(joint);
        let tiles = self.data.as_mut_slice().chunks_exact_mut(count * TILE_ROWS);
        for (tile, variables) in tiles.zip(variables.chunks(TILE_ROWS)) {
            let column = &mut tile[first * TILE_ROWS..];
            if has_sines {
                let (sine, cosine) = column.split_at_mut(TILE_ROWS);
                sines_cosines(variables, sine, cosine);
                fill_up(sine, variables.len());
                fill_up(cosine, variables.len());
            } else {
                column[..variables.len()].copy_from_slice(variables);
                fill_up(column, variables.len());
            }
        }
    }

    /// Number of poses.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Always false: a batch has at least one pose.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// One motion per row of the chain.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    pub(crate) fn tiles(&self) -> usize {
        self.rows.div_ceil(TILE_ROWS)
    }

    /// The columns of a tile, and how many of its rows are poses.
    pub(crate) fn tile(&self, tile: usize) -> (&[f64], usize) {
        let size = self.columns.count * TILE_ROWS;
        let rows = (self.rows - tile * TILE_ROWS).min(TILE_ROWS);
        (&self.data.as_slice()[tile * size..][..size], rows)
    }

    /// The model must be of a chain of the same motions.
    pub(crate) fn check(&self, model: &DistanceModel) -> Result<(), BatchError> {
        let differs = |(a, b): (&Motion, &Motion)| a != b;
        let (own, others) = (&self.motions, &model.motions);
        if own.len() == others.len() && !own.iter().zip(others).any(differs) {
            return Ok(());
        }
        let same = own.iter().zip(others).take_while(|(a, b)| a == b).count();
        Err(BatchError::Length {
            what: "rows of the model that move as those of the batch",
            expected: own.len().max(others.len()),
            found: same,
        })
    }
}

/// Repeats the last pose: its weight will be 0, its distance must have a derivative.
fn fill_up(column: &mut [f64], filled: usize) {
    if let Some(&last) = filled.checked_sub(1).and_then(|last| column.get(last)) {
        column[filled..TILE_ROWS].fill(last);
    }
}

fn check_all(what: &'static str, values: &[f64]) -> Result<(), BatchError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(pose) => Err(not_finite(what, pose, values[pose])),
    }
}

pub(crate) fn not_finite(what: &'static str, pose: usize, value: f64) -> BatchError {
    BatchError::Pose {
        what,
        pose,
        value,
        allowed: "a finite number",
    }
}

fn weight_error(pose: usize, value: f64) -> BatchError {
    BatchError::Pose {
        what: "the weight",
        pose,
        value,
        allowed: "a finite number of at least 0",
    }
}
