//! Readings of the sensors: noise, rounding, scale, digits of the log.

use std::f64::consts::TAU;

use crate::effects::{Effect, Stage};
use crate::random::Random;
use crate::rig::noise::NoisePlan;
use crate::rig::scene::{Recorded, Scene, stream};
use haptical_model::Recording;

/// Standard deviation of a torque reading \[N m\].
const TORQUE_SD_NM: f64 = 4e-3;
const FORCE_SD_N: f64 = 0.01;
const TEMPERATURE_SD_K: f64 = 0.03;

impl Scene<'_> {
    pub(crate) fn read_outputs(
        &self,
        clean: Vec<Vec<f64>>,
        noise: &NoisePlan,
        into: &mut Recorded,
    ) {
        for (index, (joint, clean)) in self.device.joints.iter().zip(clean).enumerate() {
            let counts = joint.external_encoder_counts_per_rev;
            let count = counts.map(|counts| TAU / counts);
            let mut random = Random::new(self.seed(), stream::OUTPUT + index as u64);
            let read = joint.output_sd_rad().map(|sd| {
                let speed = &self.motion.rate_rad_s[index];
                noise.output[index].read(&clean, speed, sd, count, &mut random)
            });
            into.clean.output_rad.push(read.is_some().then_some(clean));
            into.log.output.push(read);
        }
    }

    pub(crate) fn read_cables(&self, clean: Vec<Vec<f64>>, noise: &NoisePlan, into: &mut Recorded) {
        for (index, clean) in clean.into_iter().enumerate() {
            let cable = &self.device.cables[index];
            let drum = cable.drum_radius_m.zip(cable.counts_per_rev);
            let count = drum.map(|(radius, counts)| TAU * radius / counts);
            let mut random = Random::new(self.seed(), stream::CABLE + 1000 * index as u64);
            let read = self.device.cable_sd_m(index).map(|sd| {
                let last = clean.len().saturating_sub(1);
                let speed = |row: usize| clean[(row + 1).min(last)] - clean[row.saturating_sub(1)];
                let speed: Vec<f64> = (0..clean.len()).map(speed).collect();
                noise.cable.read(&clean, &speed, sd, count, &mut random)
            });
            into.clean.cable_m.push(read.is_some().then_some(clean));
            into.log.cable_m.push(read);
        }
    }

    pub(crate) fn read_covariates(&self, effects: &[Effect], scale: &[f64], log: &mut Recording) {
        let mut torque_nm = self.torque_nm.clone();
        let mut force_n: [Vec<f64>; 3] =
            [0, 1, 2].map(|axis| self.force_n.iter().map(|force| force[axis]).collect());
        for effect in effects {
            effect.columns(Stage::Torque, self, &mut torque_nm);
            effect.columns(Stage::Force, self, &mut force_n);
        }
        let mut random = Random::new(self.seed(), stream::TORQUE);
        let mut read = |column: Vec<f64>, scale: f64, sd: f64, digits: f64| -> Vec<f64> {
            column
                .into_iter()
                .map(|value| rounded(value * scale + sd * random.normal(), digits))
                .collect()
        };
        log.torque_nm = torque_nm
            .into_iter()
            .zip(scale)
            .map(|(column, scale)| Some(read(column, *scale, TORQUE_SD_NM, 1e4)))
            .collect();
        log.force_n = Some(force_n.map(|column| read(column, 1.0, FORCE_SD_N, 1e4)));
        let degc = self.temperature_degc.clone();
        log.temperature_degc = Some(read(degc, 1.0, TEMPERATURE_SD_K, 1e3));
    }
}

/// Rounded to `1 / scale`, as a log prints it.
pub(crate) fn rounded(value: f64, scale: f64) -> f64 {
    libm::round(value * scale) / scale
}
