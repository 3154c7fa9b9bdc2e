//! An encoder: what it shows for a true value.

use std::f64::consts::TAU;

use haptical_model::{Cable, Joint};
use rand_chacha::ChaCha8Rng;

use crate::sampling::{joint_part, required};
use crate::settings::{CableSigma, Noise, Settings};
use crate::streams::normal;
use crate::{Part, SimulatorError};

/// The paper takes a third of an encoder's largest quantization error as its standard deviation.
const COUNTS_PER_SD: f64 = 3.0;

/// One encoder with its own random numbers.
#[derive(Debug, Clone)]
pub(crate) struct Sensor {
    /// Standard deviation and the numbers it scales.
    gaussian: Option<(f64, ChaCha8Rng)>,
    /// Length of a count.
    count: Option<f64>,
}

impl Sensor {
    /// The motor-side encoder of a joint (index from 0), in units of the joint reading.
    pub(crate) fn motor(
        joint: &Joint,
        index: usize,
        settings: &Settings,
    ) -> Result<Self, SimulatorError> {
        if !settings.motor_counts {
            return Ok(Self::exact());
        }
        let (part, key) = (joint_part(joint, index), "encoder_counts_per_rev");
        let purpose = "rounding of the motor-side readings";
        let turns = TAU / required(joint.encoder_counts_per_rev, &part, key, purpose)?;
        let ratio = joint.transmission_ratio.abs();
        let ratio = required(Some(ratio), &part, "transmission_ratio", purpose)?;
        Ok(Self {
            gaussian: None,
            count: Some(turns / ratio),
        })
    }

    /// The external encoder of a joint (index from 0).
    pub(crate) fn output(
        joint: &Joint,
        index: usize,
        noise: Noise,
        generator: ChaCha8Rng,
    ) -> Result<Self, SimulatorError> {
        let part = joint_part(joint, index);
        let counts = |purpose: &'static str| {
            let key = "external_encoder_counts_per_rev";
            required(joint.external_encoder_counts_per_rev, &part, key, purpose)
        };
        let sd = || {
            let (key, purpose) = (
                "external_encoder_sd_rad",
                "normal noise of the external encoder",
            );
            match joint.external_encoder_sd_rad {
                None if joint.external_encoder_counts_per_rev.is_some() => {
                    Ok(TAU / counts(purpose)? / COUNTS_PER_SD)
                }
                stated => required(stated, &part, key, purpose),
            }
        };
        let count = || Ok(TAU / counts("rounding of the external encoder")?);
        Self::with_noise(noise, sd, count, generator)
    }

    /// A sensor with one kind of noise; only what that needs is asked for.
    fn with_noise(
        noise: Noise,
        sd: impl FnOnce() -> Result<f64, SimulatorError>,
        count: impl FnOnce() -> Result<f64, SimulatorError>,
        generator: ChaCha8Rng,
    ) -> Result<Self, SimulatorError> {
        let sd = noise.has_gaussian().then(sd).transpose()?;
        Ok(Self {
            gaussian: sd.map(|sd| (sd, generator)),
            count: noise.has_counts().then(count).transpose()?,
        })
    }

    /// A cable encoder (index from 0).
    pub(crate) fn cable(
        cable: &Cable,
        index: usize,
        settings: &Settings,
        generator: ChaCha8Rng,
    ) -> Result<Self, SimulatorError> {
        let part = Part::Cable { number: index + 1 };
        let count = |purpose: &'static str| {
            let radius = required(cable.drum_radius_m, &part, "drum_radius_m", purpose)?;
            let counts = required(cable.counts_per_rev, &part, "counts_per_rev", purpose)?;
            Ok::<f64, SimulatorError>(TAU * radius / counts)
        };
        let sd = || {
            let purpose = "normal noise of the cable encoder";
            match settings.cable_sigma {
                CableSigma::Stated => {
                    required(cable.distance_sd_m, &part, "distance_sd_m", purpose)
                }
                // R_d sigma_e = R_d 2 pi / counts / 3 is a third of a count
                CableSigma::Geometric => Ok(count(purpose)? / COUNTS_PER_SD),
                CableSigma::Printed => Ok(TAU * (count(purpose)? / COUNTS_PER_SD)),
            }
        };
        let rounding = || count("rounding of the cable encoder");
        Self::with_noise(settings.cable_noise, sd, rounding, generator)
    }

    /// A sensor that shows true values.
    pub(crate) fn exact() -> Self {
        Self {
            gaussian: None,
            count: None,
        }
    }

    /// A sensor with normal noise alone.
    pub(crate) fn noisy(sd: f64, generator: ChaCha8Rng) -> Self {
        Self {
            gaussian: (sd > 0.0).then_some((sd, generator)),
            count: None,
        }
    }

    /// Length of a count; 0 if the encoder does not count.
    pub(crate) fn count(&self) -> f64 {
        self.count.unwrap_or(0.0)
    }

    /// What the encoder shows for a true value.
    pub(crate) fn read(&mut self, value: f64) -> f64 {
        let noisy = match &mut self.gaussian {
            Some((sd, generator)) => value + *sd * normal(generator),
            None => value,
        };
        match self.count {
            Some(count) => libm::round(noisy / count) * count,
            None => noisy,
        }
    }
}
