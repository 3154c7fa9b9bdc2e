//! What a step with effects is told, and what it refuses of it.

use crate::RuntimeError;

/// What a control loop knows at one instant. Numbers that no effect of the device needs stay 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs<const JOINTS: usize> {
    /// Motor-side encoder angles over the nominal ratios \[rad\], \[m\].
    pub readings: [f64; JOINTS],
    /// Torques of the drives at the joints \[Nm\], \[N\]: as they were recorded for the calibration.
    pub torque_nm: [f64; JOINTS],
    /// Rates of the readings.
    pub velocity: [f64; JOINTS],
    /// Accelerations of the readings.
    pub acceleration: [f64; JOINTS],
    /// Force of the hand on the handle as its sensor reads it, in the handle's axes \[N\].
    pub force_n: [f64; 3],
    /// Acceleration of the handle in frame (-1): a payload's.
    pub handle_acceleration_mps2: [f64; 3],
    /// Time since the start \[s\].
    pub time_s: f64,
    /// Temperature.
    pub temperature_degc: f64,
}

/// Largest size of an input: seconds since 1970 are less.
const LARGEST_INPUT: f64 = 1e12;

impl<const JOINTS: usize> Inputs<JOINTS> {
    /// Readings alone.
    #[must_use]
    pub const fn at(readings: [f64; JOINTS]) -> Self {
        Self {
            readings,
            torque_nm: [0.0; JOINTS],
            velocity: [0.0; JOINTS],
            acceleration: [0.0; JOINTS],
            force_n: [0.0; 3],
            handle_acceleration_mps2: [0.0; 3],
            time_s: 0.0,
            temperature_degc: 0.0,
        }
    }

    /// Refuses what is not finite; readings are the model's business.
    #[inline]
    pub(super) fn check(&self) -> Result<(), RuntimeError> {
        let lists: [(&'static str, &[f64]); 7] = [
            ("torque", &self.torque_nm),
            ("velocity", &self.velocity),
            ("acceleration", &self.acceleration),
            ("force", &self.force_n),
            ("acceleration of the handle", &self.handle_acceleration_mps2),
            ("time", core::slice::from_ref(&self.time_s)),
            ("temperature", core::slice::from_ref(&self.temperature_degc)),
        ];
        for (quantity, values) in lists {
            for (index, &value) in values.iter().enumerate() {
                // NaN is not inside either
                let is_inside = value.abs() <= LARGEST_INPUT;
                if !is_inside {
                    return Err(RuntimeError::Input {
                        quantity,
                        number: index + 1,
                        value,
                    });
                }
            }
        }
        Ok(())
    }
}
