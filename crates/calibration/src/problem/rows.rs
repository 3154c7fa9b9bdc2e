//! Residuals and derivatives of a recording, row by row, for any channels and parameters.

use std::ops::Range;

use haptical_identification::{IdentificationError, Matrix};
use haptical_model::{Device, Evaluation, ModelError};

use crate::problem::channel::with_kind;
use crate::problem::device_problem::Block;
use crate::problem::lanes::transmission::errors_in_bulk;
use crate::problem::measurement::kind::{Measurement, Posture};
use crate::{Channel, DeviceProblem};

/// Rows that one thread works out at a time.
const ROWS_AT_ONCE: usize = 512;

/// Rows of a part where triangles are made of many, so that its derivatives stay in a core's memory, and parts of a triangle.
const ROWS_OF_MANY: usize = 128;
const PARTS_OF_MANY: usize = 64;
/// Rows that are many.
const MANY: usize = 100_000;

/// Where a block's residuals of some rows are.
fn within(block: &Block, rows: &Range<usize>) -> Range<usize> {
    let place = |row: usize| {
        let before = block.rows.partition_point(|&other| other < row);
        block.first + before * block.channel.width()
    };
    place(rows.start)..place(rows.end)
}

/// Rows of a part.
fn part_of(part: usize, length: usize, rows: usize) -> Range<usize> {
    part * length..((part + 1) * length).min(rows)
}

/// Residuals and derivatives of some rows.
#[derive(Default)]
pub(crate) struct PartRoom {
    pub(crate) residuals: Vec<f64>,
    pub(crate) derivatives: Option<Matrix>,
}

impl DeviceProblem<'_> {
    /// Residuals and derivatives of all rows; many rows in parallel, each as it is alone.
    pub(crate) fn run(
        &self,
        values: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let rows = self.recording.len();
        if rows <= ROWS_AT_ONCE {
            let device = self.device_with(values);
            let firsts: Vec<usize> = self.blocks.iter().map(|block| block.first).collect();
            return self.run_some(&device, 0..rows, &firsts, residuals, &mut jacobian);
        }
        let free = jacobian.as_ref().map(|(free, _)| *free);
        let parts = self.by_part(values, free)?;
        for (index, part) in parts.iter().enumerate() {
            for (whole, own) in self.places(&part_of(index, ROWS_AT_ONCE, rows)) {
                residuals[whole.clone()].copy_from_slice(&part.residuals[own.clone()]);
                if let (Some((_, matrix)), Some(derivatives)) = (&mut jacobian, &part.derivatives) {
                    for column in 0..derivatives.columns() {
                        matrix.column_mut(column)[whole.clone()]
                            .copy_from_slice(&derivatives.column(column)[own.clone()]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Residuals and derivatives of every part of the rows, in their order: all blocks' residuals of the part, one block
    /// after the other. The first part that is refused is reported, whichever thread met it first.
    fn by_part(
        &self,
        values: &[f64],
        free: Option<&[usize]>,
    ) -> Result<Vec<PartRoom>, IdentificationError> {
        let device = self.device_with(values);
        let rows = self.recording.len();
        let parts = 0..rows.div_ceil(ROWS_AT_ONCE).max(1);
        let made = haptical_parallel::map(parts, |part| {
            let mut room = PartRoom::default();
            self.run_part(&device, &part_of(part, ROWS_AT_ONCE, rows), free, &mut room)?;
            Ok(room)
        });
        made.into_iter().collect()
    }

    /// What `fold` makes of successive parts of the rows, begun with `new`, in their order: of each part's rows, residuals
    /// and derivatives as [`DeviceProblem::by_part`] has them. Of many rows one result is of many parts.
    pub(crate) fn fold_parts<T: Send>(
        &self,
        values: &[f64],
        free: &[usize],
        new: impl Fn() -> T + Sync,
        fold: impl Fn(&mut T, &Range<usize>, &PartRoom) -> Result<(), IdentificationError> + Sync,
    ) -> Result<Vec<T>, IdentificationError> {
        let device = self.device_with(values);
        let rows = self.recording.len();
        let (length, count) = match rows > MANY {
            true => (ROWS_OF_MANY, PARTS_OF_MANY),
            false => (ROWS_AT_ONCE, 1),
        };
        let parts: Vec<usize> = (0..rows.div_ceil(length).max(1)).collect();
        let made = haptical_parallel::map(parts.chunks(count), |parts| {
            let (mut folded, mut room) = (new(), PartRoom::default());
            for &part in parts {
                let rows = part_of(part, length, rows);
                self.run_part(&device, &rows, Some(free), &mut room)?;
                fold(&mut folded, &rows, &room)?;
            }
            Ok(folded)
        });
        made.into_iter().collect()
    }

    /// Residuals of a part's rows, and their derivatives by what is `free`.
    fn run_part(
        &self,
        device: &Device,
        rows: &Range<usize>,
        free: Option<&[usize]>,
        room: &mut PartRoom,
    ) -> Result<(), IdentificationError> {
        let places: Vec<Range<usize>> = self.places(rows).map(|(_, own)| own).collect();
        let firsts: Vec<usize> = places.iter().map(|own| own.start).collect();
        let count = places.last().map_or(0, |own| own.end);
        room.residuals.clear();
        room.residuals.resize(count, 0.0);
        match (&mut room.derivatives, free) {
            (Some(matrix), Some(free))
                if matrix.rows() == count && matrix.columns() == free.len() =>
            {
                (0..free.len()).for_each(|column| matrix.column_mut(column).fill(0.0));
            }
            (matrix, _) => *matrix = free.map(|free| Matrix::zeros(count, free.len())),
        }
        let mut jacobian = free.zip(room.derivatives.as_mut());
        let residuals = &mut room.residuals;
        self.run_some(device, rows.clone(), &firsts, residuals, &mut jacobian)
    }

    /// Ranges of each block's residuals of a part's rows: within the problem, and within the part.
    pub(crate) fn places(
        &self,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let mut first = 0;
        self.blocks.iter().map(move |block| {
            let whole = within(block, rows);
            let own = first..first + whole.len();
            first = own.end;
            (whole, own)
        })
    }

    /// Rows of the recording in tiles or, where these refuse, row by row, which names what is wrong.
    fn run_some(
        &self,
        device: &Device,
        rows: Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let bulk = match jacobian {
            None => self.run_encoders(device, &rows, firsts, residuals),
            Some(_) => None,
        };
        match bulk.or_else(|| self.run_tiles(device, &rows, firsts, residuals, jacobian)) {
            Some(()) => {}
            None => self.run_rows(device, rows.clone(), firsts, residuals, jacobian)?,
        }
        self.add_effects(device, &rows, firsts, residuals, jacobian);
        Ok(())
    }

    /// Residuals of external encoders, whose transmissions are worked out in bulk; none where the chain is asked for, or a
    /// number is refused, which the form row by row names.
    fn run_encoders(
        &self,
        device: &Device,
        rows: &Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
    ) -> Option<()> {
        if self.sees_chain {
            return None;
        }
        for (block, &first) in self.blocks.iter().zip(firsts) {
            let Channel::Output { joint } = block.channel else {
                return None;
            };
            let measured = self.recording.output.get(joint)?.as_ref()?;
            let readings = self.recording.joint.get(joint)?;
            let own = |row: usize| block.rows.partition_point(|&other| other < row);
            let own = own(rows.start)..own(rows.end);
            let at = block.rows.get(own.clone())?;
            let angles: Vec<f64> = at.iter().map(|&row| readings[row]).collect();
            if !angles.iter().all(|angle| angle.is_finite()) {
                return None;
            }
            let errors = errors_in_bulk(device, joint, &angles)?;
            let pairs = angles.iter().zip(errors);
            let weights = block.weights.get(own.clone())?;
            let into = residuals.get_mut(first..first + own.len())?.iter_mut();
            for (into, ((row, weight), (angle, error))) in
                into.zip(at.iter().zip(weights).zip(pairs))
            {
                *into = weight * (angle + error - measured[*row]);
            }
        }
        Some(())
    }

    /// Rows of the recording, each block's residuals written from its entry of `firsts` on.
    pub(crate) fn run_rows(
        &self,
        device: &Device,
        rows: Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; device.joints.len()];
        let begins: Vec<usize> = self
            .blocks
            .iter()
            .map(|block| block.rows.partition_point(|&row| row < rows.start))
            .collect();
        let mut cursors = begins.clone();
        let mountings = self.mountings(device, &rows);
        for row in rows {
            self.move_to_row(&mut evaluation, &mut readings, row, jacobian.is_some())?;
            for (position, (block, cursor)) in self.blocks.iter().zip(&mut cursors).enumerate() {
                if block.rows.get(*cursor) != Some(&row) {
                    continue;
                }
                if let Channel::Output { joint } = block.channel
                    && !self.sees_chain
                {
                    evaluation
                        .move_joint(joint, self.recording.joint[joint][row])
                        .map_err(|error| self.at_row(row, &error))?;
                }
                let at = Posture {
                    device,
                    evaluation: &evaluation,
                    recording: self.recording,
                    row,
                    subject: block.subjects.get(*cursor).copied().unwrap_or(0),
                    mount: self.mount(row),
                    mountings: &mountings,
                };
                let width = block.channel.width();
                let first = firsts[position] + (*cursor - begins[position]) * width;
                let (own, weight) = (first..first + width, block.weights[*cursor]);
                with_kind!(block.channel, kind => {
                    self.reading(&kind, &at, weight, own, residuals, jacobian)
                })
                .map_err(|error| self.at_row(row, &error))?;
                *cursor += 1;
            }
        }
        Ok(())
    }

    /// The residuals `own` of one reading, and their derivatives.
    fn reading<M: Measurement>(
        &self,
        kind: &M,
        at: &Posture<'_>,
        weight: f64,
        own: Range<usize>,
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), ModelError> {
        let (values, seen) = kind.see(at, weight)?;
        residuals[own.clone()].copy_from_slice(&values[..own.len()]);
        if let Some((free, matrix)) = jacobian {
            for (position, &index) in free.iter().enumerate() {
                let parameter = self.parameters[index];
                let values = match kind.sees(parameter) {
                    true => kind.derivative(&seen, at, parameter),
                    false => [0.0; 3],
                };
                matrix.column_mut(position)[own.clone()].copy_from_slice(&values[..own.len()]);
            }
        }
        Ok(())
    }

    /// Moves to a row of the recording; without `derivatives`, outputs and pose alone are those of the row.
    pub(crate) fn move_to_row(
        &self,
        evaluation: &mut Evaluation<'_>,
        readings: &mut [f64],
        row: usize,
        derivatives: bool,
    ) -> Result<(), IdentificationError> {
        if !self.sees_chain {
            return Ok(());
        }
        self.recording.read_joints(row, readings);
        evaluation.choose_hand(self.device.hand_at(self.recording, row));
        if let Some(loads) = &self.loads {
            evaluation.set_torques(loads.of_row(row));
        }
        let moved = match &self.outputs {
            Some(outputs) => {
                let first = row * readings.len();
                evaluation.move_outputs(&outputs[first..first + readings.len()])
            }
            None if derivatives => evaluation.move_to(readings),
            None => evaluation.move_pose_to(readings),
        };
        moved.map_err(|error| self.at_row(row, &error))
    }

    fn at_row(&self, row: usize, error: &ModelError) -> IdentificationError {
        IdentificationError::Evaluation {
            reason: format!("line {} of the log: {error}", self.recording.line[row]),
        }
    }
}
