//! The reading of the motor-side encoder for an output angle: the transmission of eq. (1), (2) inverted.

use haptical_model::{Joint, ModelError, TransmissionError};

/// Steps of the fixed-point iteration; each shrinks the rest by the error's slope, about 0.01.
const ITERATIONS: usize = 4;
/// The iteration ends when a step moves the reading by less \[rad\].
const LAST_STEP_RAD: f64 = 1e-9;

/// One joint's transmission, followed along a motion.
#[derive(Debug)]
pub(crate) struct Drive<'d> {
    joint: &'d Joint,
    number: usize,
    is_ideal: bool,
    error_rad: f64,
}

impl<'d> Drive<'d> {
    pub(crate) fn new(joint: &'d Joint, index: usize) -> Self {
        Self {
            joint,
            number: index + 1,
            is_ideal: joint.transmission_error == TransmissionError::default(),
            error_rad: 0.0,
        }
    }

    /// The reading at which the output is at `output_rad`: the solution of
    /// `reading + error(reading) = output`, from the last reading's error on.
    pub(crate) fn reading_rad(&mut self, output_rad: f64) -> Result<f64, ModelError> {
        if self.is_ideal {
            return Ok(output_rad);
        }
        let mut reading_rad = output_rad - self.error_rad;
        for _ in 0..ITERATIONS {
            self.error_rad =
                self.joint
                    .error_rad(reading_rad)
                    .map_err(|source| ModelError::Transmission {
                        joint: self.number,
                        source,
                    })?;
            let next_rad = output_rad - self.error_rad;
            let step_rad = (next_rad - reading_rad).abs();
            reading_rad = next_rad;
            if step_rad < LAST_STEP_RAD {
                break;
            }
        }
        Ok(reading_rad)
    }
}
