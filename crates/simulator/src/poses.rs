//! Draws the poses of a device, clear of the points where its cables leave their guides.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{KinematicsError, distance_m};
use haptical_model::{Cable, Device, Evaluation, ModelError};
use rand_chacha::ChaCha8Rng;

use crate::SimulatorError;
use crate::sampling::JointSampler;
use crate::settings::Settings;
use crate::streams::{Stream, seek_row};

/// Poses drawn for one row before it counts as impossible to stay clear of the cable exits.
const MAX_POSES: usize = 1000;

/// Random poses of a device that stay clear of the cable exits.
#[derive(Debug)]
pub(crate) struct PoseSampler<'d> {
    truth: &'d Device,
    joints: Vec<JointSampler>,
    generator: ChaCha8Rng,
    minimum_distance_m: f64,
    /// The device at the row's pose.
    pub(crate) evaluation: Evaluation<'d>,
    /// Readings of the row, unrounded.
    pub(crate) readings: Vec<f64>,
    /// Lengths of the cables of the row; zero for a device without links.
    pub(crate) distances_m: Vec<f64>,
}

impl<'d> PoseSampler<'d> {
    pub(crate) fn new(
        truth: &'d Device,
        settings: &Settings,
        seed: u64,
    ) -> Result<Self, SimulatorError> {
        let joints = truth
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| JointSampler::new(joint, index, settings))
            .collect::<Result<Vec<JointSampler>, SimulatorError>>()?;
        Ok(Self {
            truth,
            readings: vec![0.0; joints.len()],
            distances_m: vec![0.0; truth.cables.len()],
            joints,
            generator: Stream::Poses.open(0, seed),
            minimum_distance_m: settings.minimum_distance_m,
            evaluation: Evaluation::new(truth),
        })
    }

    /// Draws the pose of a row and evaluates the device there.
    pub(crate) fn move_to_row(&mut self, row: usize) -> Result<(), SimulatorError> {
        let at_row = |source: ModelError| SimulatorError::Row { row, source };
        seek_row(&mut self.generator, row);
        for _ in 0..MAX_POSES {
            for (reading, joint) in self.readings.iter_mut().zip(&self.joints) {
                *reading = joint.draw(&mut self.generator)?;
            }
            self.evaluation.move_to(&self.readings).map_err(at_row)?;
            if !self.truth.has_links() || self.measure_cables().map_err(at_row)? {
                return Ok(());
            }
        }
        Err(SimulatorError::TooNearCableExit {
            row,
            attempts: MAX_POSES,
            minimum_distance_m: self.minimum_distance_m,
        })
    }

    /// Whether every cable is long enough; keeps the distances.
    fn measure_cables(&mut self) -> Result<bool, ModelError> {
        let handle_m = self.evaluation.pose()?.position_m;
        for (distance, cable) in self.distances_m.iter_mut().zip(&self.truth.cables) {
            *distance = way_m(cable, &handle_m)?;
        }
        let mut distances = self.distances_m.iter();
        Ok(distances.all(|distance_m| *distance_m > 0.0 && *distance_m >= self.minimum_distance_m))
    }
}

/// Distance from a cable's exit to the handle, 0 where they coincide \[m\].
pub(crate) fn way_m(cable: &Cable, handle_m: &Vector3<f64>) -> Result<f64, ModelError> {
    match distance_m(handle_m, &Vector3::from(cable.anchor_m)) {
        Err(KinematicsError::ZeroDistance { .. }) => Ok(0.0),
        other => Ok(other?),
    }
}
