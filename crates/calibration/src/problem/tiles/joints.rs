//! Output angles of some rows of a recording, joint by joint, with the slopes of fitted transmission errors.

use std::ops::Range;

use haptical_batch::{Lane, POSTURES};
use haptical_model::{Device, Drive, ParameterId};

use crate::DeviceProblem;
use crate::problem::lanes::capstan::ErrorValues;
use crate::problem::lanes::transmission::{ErrorRows, error_of, errors_in_bulk};

/// Angles of the joints at some rows.
pub(super) struct JointRows {
    /// Joint by joint.
    pub(super) outputs: Vec<Vec<f64>>,
    /// Joint by joint, the error's derivatives by its parameters; empty where none of them is free.
    slopes: Vec<Vec<Vec<f64>>>,
}

impl JointRows {
    /// None where a law refuses a number: the form row by row names it.
    pub(super) fn new(
        problem: &DeviceProblem<'_>,
        device: &Device,
        rows: &Range<usize>,
        free: &[usize],
    ) -> Option<Self> {
        let count = device.joints.len();
        let is_free = |joint: usize| {
            let mut chosen = free.iter().map(|&index| problem.parameters[index]);
            chosen.any(
                |id| matches!(id, ParameterId::Transmission { joint: own, .. } if own == joint),
            )
        };
        let mut outputs = Vec::with_capacity(count);
        let mut slopes = vec![Vec::new(); count];
        for (joint, slopes) in slopes.iter_mut().enumerate() {
            if let Some(fixed) = &problem.outputs {
                let own = fixed.iter().skip(joint).step_by(count);
                outputs.push(own.skip(rows.start).take(rows.len()).copied().collect());
                continue;
            }
            let readings = problem.recording.joint.get(joint)?.get(rows.clone())?;
            if !readings.iter().all(|reading| reading.is_finite()) {
                return None;
            }
            let errors = match is_free(joint) {
                true => with_slopes(device, joint, readings, slopes)?,
                false => errors_in_bulk(device, joint, readings)?,
            };
            let sums = readings.iter().zip(errors);
            outputs.push(sums.map(|(reading, error)| reading + error).collect());
        }
        Some(Self { outputs, slopes })
    }

    /// A row's variable at a tile's entries; behind the last one it is repeated.
    pub(super) fn variable(
        &self,
        drive: &Drive,
        entries: &[usize],
        yielded: impl Fn(usize) -> f64,
        into: &mut Lane,
    ) {
        let outputs = &self.outputs[drive.joint];
        let last = entries.last().into_iter().cycle();
        for (variable, &entry) in into.iter_mut().zip(entries.iter().chain(last)) {
            *variable = drive.multiplier * (outputs[entry] - yielded(entry));
        }
    }

    /// The error's derivative by one of its parameters; empty where none of them is free.
    pub(super) fn slope(&self, joint: usize, index: usize) -> &[f64] {
        self.slopes[joint].get(index).map_or(&[], Vec::as_slice)
    }

    /// The same at a tile's entries as a lane.
    pub(super) fn slope_lane(&self, joint: usize, index: usize, entries: &[usize]) -> Lane {
        let own = self.slope(joint, index);
        let mut lane = [0.0; POSTURES];
        for (into, &entry) in lane.iter_mut().zip(entries) {
            *into = own.get(entry).copied().unwrap_or(0.0);
        }
        lane
    }
}

/// Errors of a joint's transmission, and their derivatives by all its parameters.
fn with_slopes(
    device: &Device,
    joint: usize,
    readings: &[f64],
    slopes: &mut Vec<Vec<f64>>,
) -> Option<Vec<f64>> {
    let (described, error) = error_of(device, joint)?;
    if let Some(rows) = ErrorRows::new(described, readings) {
        let mut at = ErrorValues::default();
        rows.evaluate(&error, true, &mut at)?;
        slopes.extend(rows.derivatives(&at).iter().cloned());
        return Some(at.values);
    }
    slopes.resize(error.len(), vec![0.0; readings.len()]);
    let mut derivatives = vec![0.0; error.len()];
    let mut values = Vec::with_capacity(readings.len());
    for (entry, &reading) in readings.iter().enumerate() {
        let (value, _) = described.evaluate_error(reading, &mut derivatives).ok()?;
        values.push(value);
        for (column, slope) in slopes.iter_mut().zip(&derivatives) {
            column[entry] = *slope;
        }
    }
    Some(values)
}
