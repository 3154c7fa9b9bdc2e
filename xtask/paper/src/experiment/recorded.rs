//! The paper's experiment itself: one recorded motion, both steps on random samples of it.

use anyhow::{Context, Result};
use haptical_metrics::rms;
use haptical_model::{Device, Recording};
use haptical_simulator::{Effects, MotionSettings, record_motion};
use xtask_blind::Random;

use super::improvement::distance_errors_m;
use crate::run::{Run, on_samples, rough_options, sample, step_two_on};
use crate::scenario::Scenario;

/// A recorded motion with the calibration made from it.
#[derive(Debug)]
pub(crate) struct Recorded {
    pub(crate) recording: Recording,
    pub(crate) run: Run,
    /// The nominal device with the fitted transmissions.
    pub(crate) compensated: Device,
    /// Kinematics refitted without transmission errors.
    pub(crate) alone: Device,
}

/// The distance at an instant, and what two devices get wrong.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub(crate) time_s: f64,
    pub(crate) measured_m: f64,
    pub(crate) before_m: f64,
    pub(crate) after_m: f64,
}

impl Recorded {
    /// Records about 100 s at 1 kHz and calibrates on the paper's numbers of random samples.
    pub(crate) fn new(scenario: &Scenario, seed: u64) -> Result<Self> {
        let settings = MotionSettings::default();
        let effects = Effects::none().with_assumed_roughness(&scenario.truth)?;
        let recording = record_motion(&scenario.truth, &effects, &settings, seed)?;
        let mut random = Random::new(seed, 2);
        let found = on_samples(scenario, &recording, &mut random)?;
        let options = rough_options(scenario);
        let alone = step_two_on(&scenario.nominal, &found.data, &options)?.device;
        let readings = sample(&recording, scenario.evaluation_poses, &mut random);
        Ok(Self {
            recording,
            run: Run {
                pose: scenario.pose_errors(&found.kinematics.device, &readings)?,
                transmissions: found.transmissions,
                transmission_data: found.transmission_data,
                kinematics: found.kinematics,
            },
            compensated: found.compensated,
            alone,
        })
    }

    /// Every `step`-th row's distance, with its errors by the nominal and the calibrated device.
    pub(crate) fn distances(&self, nominal: &Device, step: usize) -> Result<Vec<Instant>> {
        let time_s = self.recording.time_s.as_ref().context("no time")?;
        let cable = self.recording.cable_m.first().and_then(Option::as_ref);
        let cable = cable.context("no cable")?;
        let before = distance_errors_m(nominal, &self.recording)?;
        let after = distance_errors_m(&self.run.kinematics.device, &self.recording)?;
        Ok((0..self.recording.len())
            .step_by(step)
            .map(|row| Instant {
                time_s: time_s[row],
                measured_m: cable[row],
                before_m: before[row],
                after_m: after[row],
            })
            .collect())
    }

    /// Root mean square of the distance error over the whole motion \[m\].
    pub(crate) fn distance_rms_m(&self, device: &Device) -> Result<f64> {
        Ok(rms(&distance_errors_m(device, &self.recording)?)?)
    }
}
