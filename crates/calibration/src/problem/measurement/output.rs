//! The external encoder of a joint's output axis.

use haptical_model::{Device, ModelError, ParameterId, Recording};

use super::kind::{Measurement, Posture, is_known, reading};

/// Reading + transmission error, against the external encoder: Baser & Konukseven eq. (1).
pub(crate) struct Output {
    /// Joint, from 0.
    pub(crate) joint: usize,
}

impl Measurement for Output {
    /// The weight.
    type Seen = f64;

    fn unit(&self, device: &Device) -> &'static str {
        device.joints[self.joint].unit()
    }

    fn sees_chain(&self) -> bool {
        false
    }

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        is_known(
            recording.output.get(self.joint).and_then(Option::as_ref),
            row,
        )
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.joints[self.joint].output_sd_rad()
    }

    fn sees(&self, parameter: ParameterId) -> bool {
        match parameter {
            ParameterId::Transmission { joint, .. } => joint == self.joint,
            ParameterId::Effect { .. } => true,
            _ => false,
        }
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], f64), ModelError> {
        let measured = reading(at.recording.output[self.joint].as_ref(), at.row);
        let residual = weight * (at.evaluation.output_rad(self.joint) - measured);
        Ok(([residual, 0.0, 0.0], weight))
    }

    fn derivative(&self, weight: &f64, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let slope = at.evaluation.output_derivative(self.joint, parameter);
        [weight * slope, 0.0, 0.0]
    }
}
