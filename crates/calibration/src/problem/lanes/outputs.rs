//! The first step's problem in lanes: one transmission's parameters from its external encoder.

use std::cell::RefCell;

use haptical_identification::{IdentificationError, Triangle, TriangleProblem};
use haptical_model::{Device, ParameterId, Recording};

use crate::Channel;
use crate::problem::lanes::capstan::ErrorValues;
use crate::problem::lanes::transmission::ErrorRows;

/// Weighted residuals of one external encoder, reduced to a triangle as `haptical_batch`'s distances are.
#[derive(Debug)]
pub(crate) struct Outputs {
    law: ErrorRows,
    readings: Vec<f64>,
    measured: Vec<f64>,
    weights: Vec<f64>,
    /// All parameters of the error, as the device has them.
    error: Vec<f64>,
    /// Which of them each parameter of the problem is.
    places: Vec<usize>,
    room: RefCell<Room>,
}

#[derive(Debug, Default)]
struct Room {
    error: Vec<f64>,
    at: ErrorValues,
    residuals: Vec<f64>,
    /// Weighted derivatives with respect to one free parameter after the other.
    columns: Vec<f64>,
}

impl Outputs {
    /// `rows` are those with a reading and `weights` one over the standard deviation of each. None where the
    /// problem is another one; then the general form serves.
    pub(crate) fn new(
        device: &Device,
        recording: &Recording,
        parameters: &[ParameterId],
        channel: Channel,
        (rows, weights): (&[usize], &[f64]),
    ) -> Option<Self> {
        let Channel::Output { joint } = channel else {
            return None;
        };
        let count = device.joints.get(joint)?.error_parameter_count();
        let places: Vec<usize> = parameters
            .iter()
            .map(|parameter| match *parameter {
                ParameterId::Transmission { joint: own, index } if own == joint => {
                    (index < count).then_some(index)
                }
                _ => None,
            })
            .collect::<Option<_>>()?;
        let column = recording.joint.get(joint)?;
        let output = recording.output.get(joint)?.as_ref()?;
        let readings: Vec<f64> = rows.iter().map(|&row| column[row]).collect();
        let is_sound = !readings.is_empty() && readings.iter().all(|reading| reading.is_finite());
        let error =
            (0..count).map(|index| ParameterId::Transmission { joint, index }.value(device));
        Some(Self {
            law: is_sound
                .then(|| ErrorRows::new(&device.joints[joint], &readings))
                .flatten()?,
            measured: rows.iter().map(|&row| output[row]).collect(),
            readings,
            weights: weights.to_vec(),
            error: error.collect(),
            places,
            room: RefCell::default(),
        })
    }

    /// Residuals at `parameters`, and derivatives where asked, left in the room.
    fn fill(
        &self,
        parameters: &[f64],
        derivatives: bool,
        room: &mut Room,
    ) -> Result<(), IdentificationError> {
        room.error.clone_from(&self.error);
        for (&place, value) in self.places.iter().zip(parameters) {
            room.error[place] = *value;
        }
        let law = self.law.evaluate(&room.error, derivatives, &mut room.at);
        law.ok_or_else(|| IdentificationError::Evaluation {
            reason: "the transmission's law has no value for these parameters".to_owned(),
        })?;
        room.residuals.clear();
        let rows = self.readings.iter().zip(&self.measured);
        let rows = rows.zip(&self.weights).zip(&room.at.values);
        room.residuals.extend(
            rows.map(|(((reading, measured), weight), error)| {
                weight * (reading + error - measured)
            }),
        );
        Ok(())
    }

    /// Residuals, row by row.
    pub(crate) fn residuals(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
    ) -> Result<(), IdentificationError> {
        let room = &mut *self.room.borrow_mut();
        self.fill(parameters, false, room)?;
        residuals.copy_from_slice(&room.residuals);
        Ok(())
    }
}

impl TriangleProblem for Outputs {
    fn columns(&self) -> usize {
        self.places.len()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let room = &mut *self.room.borrow_mut();
        self.fill(parameters, !free.is_empty(), room)?;
        let rows = self.weights.len();
        room.columns.resize(free.len() * rows, 0.0);
        let derivatives = self.law.derivatives(&room.at);
        for (into, &index) in room.columns.chunks_exact_mut(rows).zip(free) {
            let slopes = derivatives[self.places[index]].iter();
            for (into, (slope, weight)) in into.iter_mut().zip(slopes.zip(&self.weights)) {
                *into = slope * weight;
            }
        }
        let columns: Vec<&[f64]> = room.columns.chunks_exact(rows).collect();
        into.clear(free.len());
        Ok(into.fold_rows(&columns, &room.residuals)?)
    }
}
