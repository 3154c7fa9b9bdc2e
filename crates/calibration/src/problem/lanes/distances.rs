//! The second step's problem in lanes: a chain's parameters from one distance, at joint angles that stay.

use std::cell::RefCell;

use haptical_batch::{
    DistanceModel, DistanceProblem, PassRoom, PoseBatch, ReducedDistance, Sines, Threads,
};
use haptical_identification::{IdentificationError, Problem, Triangle, TriangleProblem};
use haptical_model::ParameterId;

use crate::problem::lanes::cable::cable_model;
use crate::{Channel, DeviceProblem};

/// A chain and its poses, as the batch wants them.
#[derive(Debug)]
pub(crate) struct Distances {
    model: DistanceModel,
    poses: PoseBatch,
    room: RefCell<PassRoom>,
}

impl Distances {
    /// None where the problem is another one, or where a number is refused: the general form then says which, with its
    /// line of the log.
    pub(crate) fn new(problem: &DeviceProblem<'_>) -> Option<Self> {
        let [block] = problem.blocks.as_slice() else {
            return None;
        };
        let Channel::Cable { index } = block.channel else {
            return None;
        };
        let (device, outputs) = (problem.device, problem.outputs.as_deref()?);
        let parameters: Vec<_> = problem
            .parameters
            .iter()
            .map(|parameter| match parameter {
                ParameterId::Link { row, parameter } => Some((*row, *parameter)),
                _ => None,
            })
            .collect::<Option<_>>()?;
        let model = cable_model(device, index, &parameters)?;
        // the links keep their own theta: what the home pose adds stands with the joint
        let joints = device.joints.len();
        let angles: Vec<Vec<f64>> = device
            .joints
            .iter()
            .enumerate()
            .map(|(joint, described)| {
                let angles = block.rows.iter().map(|row| outputs[row * joints + joint]);
                angles.map(|angle| angle + described.home_rad).collect()
            })
            .collect();
        let cable = problem.recording.cable_m.get(index)?.as_ref()?;
        let distances_m: Vec<f64> = block.rows.iter().map(|&row| cable[row]).collect();
        let poses = PoseBatch::new(
            model.motions(),
            &angles,
            &distances_m,
            &block.weights,
            Sines::Cached,
        )
        .ok()?;
        Some(Self {
            model,
            poses,
            room: RefCell::default(),
        })
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(
        &self,
        values: &[f64],
        residuals: &mut [f64],
    ) -> Result<(), IdentificationError> {
        DistanceProblem::new(&self.model, &self.poses)?.evaluate(values, residuals, None)
    }
}

impl TriangleProblem for Distances {
    fn columns(&self) -> usize {
        self.model.parameters().len()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let reduced = ReducedDistance::new(&self.model, &self.poses, Threads::Several)?;
        let reduced = reduced.with_room(self.room.take());
        let outcome = reduced.reduce_into(parameters, free, into);
        self.room.replace(reduced.into_room());
        outcome
    }
}
