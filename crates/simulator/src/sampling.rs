//! Draws the reading of a joint.

use haptical_model::Joint;
use rand_chacha::ChaCha8Rng;

use crate::settings::{Sampling, Settings};
use crate::streams::{normal, uniform};
use crate::{Part, SimulatorError};

/// Normal readings are cut at this many standard deviations.
const CUT_SD: f64 = 3.0;

/// Draws before an interval counts as having no room. An interval that holds a share of 1e-4 of the
/// normal distribution is missed 1e5 times in a row with probability e^-10.
const MAX_DRAWS: usize = 100_000;

/// The distribution of one joint's reading.
#[derive(Debug, Clone)]
pub(crate) struct JointSampler {
    part: Part,
    /// Standard deviation where the reading is normal.
    sd: Option<f64>,
    low: f64,
    high: f64,
}

impl JointSampler {
    /// `joint` at `index`, from 0.
    pub(crate) fn new(
        joint: &Joint,
        index: usize,
        settings: &Settings,
    ) -> Result<Self, SimulatorError> {
        let part = joint_part(joint, index);
        let (lower, upper) = limits(joint, &part, |limit| match settings.sampling {
            Sampling::Normal => !limit.is_nan(),
            Sampling::Uniform => limit.is_finite(),
        })?;
        let (sd, low, high) = match settings.sampling {
            Sampling::Normal => {
                let purpose = "normal sampling";
                let sd = required(joint.sampling_sd_rad, &part, "sampling_sd_rad", purpose)?;
                (Some(sd), lower.max(-CUT_SD * sd), upper.min(CUT_SD * sd))
            }
            Sampling::Uniform => {
                let share = settings.uniform_share;
                (None, share * lower, share * upper)
            }
        };
        if low >= high {
            return Err(SimulatorError::NoRoom {
                part,
                low,
                high,
                attempts: 0,
            });
        }
        Ok(Self {
            part,
            sd,
            low,
            high,
        })
    }

    /// The next reading.
    pub(crate) fn draw(&self, generator: &mut ChaCha8Rng) -> Result<f64, SimulatorError> {
        let Some(sd) = self.sd else {
            // both products are finite where the difference of the limits might not be
            let share = uniform(generator);
            let reading = (1.0 - share) * self.low + share * self.high;
            return Ok(reading.clamp(self.low, self.high));
        };
        (0..MAX_DRAWS)
            .map(|_| sd * normal(generator))
            .find(|reading| (self.low..=self.high).contains(reading))
            .ok_or_else(|| SimulatorError::NoRoom {
                part: self.part.clone(),
                low: self.low,
                high: self.high,
                attempts: MAX_DRAWS,
            })
    }
}

pub(crate) fn joint_part(joint: &Joint, index: usize) -> Part {
    Part::Joint {
        number: index + 1,
        name: joint.name.clone(),
    }
}

/// The limits of a joint, if both are usable.
pub(crate) fn limits(
    joint: &Joint,
    part: &Part,
    is_usable: impl Fn(f64) -> bool,
) -> Result<(f64, f64), SimulatorError> {
    let limits = [
        ("lower_rad", joint.lower_rad),
        ("upper_rad", joint.upper_rad),
    ];
    match limits.into_iter().find(|(_, limit)| !is_usable(*limit)) {
        None => Ok((joint.lower_rad, joint.upper_rad)),
        Some((key, value)) => Err(SimulatorError::Value {
            part: part.clone(),
            key,
            value,
            allowed: "a finite limit",
        }),
    }
}

/// A number of the device that must be there, finite and above zero.
pub(crate) fn required(
    value: Option<f64>,
    part: &Part,
    key: &'static str,
    purpose: &'static str,
) -> Result<f64, SimulatorError> {
    match value {
        Some(value) if value > 0.0 && value.is_finite() => Ok(value),
        Some(value) => Err(SimulatorError::Value {
            part: part.clone(),
            key,
            value,
            allowed: "a finite number above zero",
        }),
        None => Err(SimulatorError::MissingKey {
            part: part.clone(),
            key,
            purpose,
        }),
    }
}
