//! Residuals and derivatives of a recording, row by row, for any channels and parameters.

use std::ops::Range;

use haptical_identification::{IdentificationError, Matrix};
use haptical_model::{Device, Evaluation, ModelError};
use rayon::prelude::*;

use crate::problem::channel::with_kind;
use crate::problem::device_problem::Block;
use crate::problem::measurement::kind::{Measurement, Posture};
use crate::problem::sink::{Place, Sink};
use crate::{Channel, DeviceProblem};

/// Rows that one thread works out at a time.
pub(crate) const ROWS_AT_ONCE: usize = 512;

/// Where a block's residuals of a part's rows stand, from row `start` on.
fn within(block: &Block, start: usize) -> Range<usize> {
    let place = |row: usize| {
        let before = block.rows.partition_point(|&other| other < row);
        block.first + before * block.channel.width()
    };
    place(start)..place(start + ROWS_AT_ONCE)
}

impl DeviceProblem<'_> {
    pub(crate) fn run(
        &self,
        values: &[f64],
        residuals: &mut [f64],
        mut sink: Sink<'_>,
    ) -> Result<(), IdentificationError> {
        let device = self.device_with(values);
        let rows = self.recording.len();
        if rows > ROWS_AT_ONCE {
            match &mut sink {
                Sink::None => return self.run_in_parallel(&device, residuals, None),
                Sink::Dense(free, matrix) => {
                    return self.run_in_parallel(&device, residuals, Some((free, matrix)));
                }
                Sink::Triangles(_) => {}
            }
        }
        let firsts: Vec<usize> = self.blocks.iter().map(|block| block.first).collect();
        self.run_rows(&device, 0..rows, &firsts, residuals, &mut sink)
    }

    /// All rows, some at a time; each is worked out as it is alone.
    fn run_in_parallel(
        &self,
        device: &Device,
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let free = jacobian.as_ref().map(|(free, _)| *free);
        let starts: Vec<usize> = (0..self.recording.len()).step_by(ROWS_AT_ONCE).collect();
        // per part: every block's residuals, one block after the other, and their derivatives
        let parts: Vec<(Vec<f64>, Option<Matrix>)> = starts
            .par_iter()
            .map(|&start| {
                let mut firsts = Vec::with_capacity(self.blocks.len());
                let mut count = 0;
                for block in &self.blocks {
                    firsts.push(count);
                    count += within(block, start).len();
                }
                let mut part = vec![0.0; count];
                let mut matrix = free.map(|free| Matrix::zeros(count, free.len()));
                let mut sink = match (free, &mut matrix) {
                    (Some(free), Some(matrix)) => Sink::Dense(free, matrix),
                    _ => Sink::None,
                };
                let end = (start + ROWS_AT_ONCE).min(self.recording.len());
                self.run_rows(device, start..end, &firsts, &mut part, &mut sink)?;
                Ok((part, matrix))
            })
            .collect::<Result<_, IdentificationError>>()?;
        for (start, (part, derivatives)) in starts.into_iter().zip(&parts) {
            let mut first = 0;
            for block in &self.blocks {
                let whole = within(block, start);
                let own = first..first + whole.len();
                first = own.end;
                residuals[whole.clone()].copy_from_slice(&part[own.clone()]);
                if let (Some((_, matrix)), Some(derivatives)) = (&mut jacobian, derivatives) {
                    for column in 0..derivatives.columns() {
                        matrix.column_mut(column)[whole.clone()]
                            .copy_from_slice(&derivatives.column(column)[own.clone()]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Rows of the recording, each block's residuals written from its entry of `firsts` on.
    fn run_rows(
        &self,
        device: &Device,
        rows: Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        sink: &mut Sink<'_>,
    ) -> Result<(), IdentificationError> {
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; device.joints.len()];
        let begins: Vec<usize> = self
            .blocks
            .iter()
            .map(|block| block.rows.partition_point(|&row| row < rows.start))
            .collect();
        let mut cursors = begins.clone();
        for row in rows {
            let derivatives = !matches!(sink, Sink::None);
            self.move_to_row(&mut evaluation, &mut readings, row, derivatives)?;
            for (position, (block, cursor)) in self.blocks.iter().zip(&mut cursors).enumerate() {
                if block.rows.get(*cursor) != Some(&row) {
                    continue;
                }
                if let Channel::Output { joint } = block.channel
                    && !self.sees_chain
                {
                    evaluation
                        .move_joint(joint, readings[joint])
                        .map_err(|error| self.at_row(row, &error))?;
                }
                let place = Place {
                    block: position,
                    channel: block.channel,
                    index: firsts[position] + (*cursor - begins[position]) * block.channel.width(),
                    weight: block.weights[*cursor],
                    row,
                    subject: block.subjects.get(*cursor).copied().unwrap_or(0),
                };
                self.residual(&place, device, &evaluation, residuals, sink)
                    .map_err(|error| self.at_row(row, &error))?;
                *cursor += 1;
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
        for (reading, column) in readings.iter_mut().zip(&self.recording.joint) {
            *reading = column[row];
        }
        if let Some(loads) = &self.loads {
            evaluation.set_torques(loads.of_row(row));
        }
        if !self.sees_chain {
            return Ok(());
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

    fn residual(
        &self,
        place: &Place,
        device: &Device,
        evaluation: &Evaluation<'_>,
        residuals: &mut [f64],
        sink: &mut Sink<'_>,
    ) -> Result<(), ModelError> {
        let at = Posture {
            device,
            evaluation,
            recording: self.recording,
            row: place.row,
            subject: place.subject,
        };
        with_kind!(place.channel, kind => {
            let (values, seen) = kind.see(&at, place.weight)?;
            let width = place.channel.width();
            residuals[place.index..][..width].copy_from_slice(&values[..width]);
            sink.put(self.parameters, place, residuals, |parameter| {
                Ok(kind.derivative(&seen, &at, parameter))
            })
        })
    }

    fn at_row(&self, row: usize, error: &ModelError) -> IdentificationError {
        IdentificationError::Evaluation {
            reason: format!("line {} of the log: {error}", self.recording.line[row]),
        }
    }
}
