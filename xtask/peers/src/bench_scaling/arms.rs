//! Arms of any number of joints, with poses and distances made by formula.

use anyhow::Result;
use haptical_calibration::{Channel, DeviceProblem, Weights};
use haptical_model::kinematics::{Convention, Link};
use haptical_model::{Cable, Device, Evaluation, Joint, Parameter, ParameterId, Recording};
use xtask_blind::Random;

/// Standard deviation of a distance \[m\], the paper's.
const SD_M: f64 = 9.87e-6;

/// An arm a little off its nominal values.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) nominal: Device,
    truth: Device,
    /// Parameters that distances can fix: all but alpha, d and theta of the first row and the last alpha.
    pub(crate) free: Vec<ParameterId>,
}

impl Arm {
    /// Axes are turned by a quarter from joint to joint, no two links are alike.
    pub(crate) fn new(joints: usize, seed: u64) -> Result<Self> {
        let mut random = Random::new(seed, 0);
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut nominal = Vec::new();
        for row in 0..=joints {
            let sign = if row % 2 == 0 { -1.0 } else { 1.0 };
            nominal.push(Link {
                a_m: 0.06 + 0.02 * row as f64,
                alpha_rad: if row == joints { 0.0 } else { sign * quarter },
                d_m: 0.05 + 0.015 * row as f64,
                theta_rad: 0.3 * row as f64,
                beta_rad: 0.0,
                b_m: 0.0,
            });
        }
        let last_twist = ParameterId::Link {
            row: joints,
            parameter: Parameter::Alpha,
        };
        let drives = vec![Joint::default(); joints];
        let mut nominal = Device::new(Convention::Standard, nominal, drives);
        nominal.cables.push(Cable {
            distance_sd_m: Some(SD_M),
            ..Cable::default()
        });
        let mut free = nominal.link_parameters(false);
        free.retain(|id| *id != last_twist);
        free.drain(1..4);
        let mut truth = nominal.clone();
        for id in &free {
            id.set(&mut truth, id.value(&nominal) + 1e-3 * random.normal());
        }
        Ok(Self {
            nominal,
            truth,
            free,
        })
    }

    /// Poses and their measured distances.
    pub(crate) fn record(&self, poses: usize, seed: u64) -> Result<Recording> {
        let mut random = Random::new(seed, 1);
        let mut evaluation = Evaluation::new(&self.truth);
        let mut angles = vec![0.0; self.truth.joints.len()];
        let mut joint = vec![Vec::with_capacity(poses); angles.len()];
        let mut distances_m = Vec::with_capacity(poses);
        for _ in 0..poses {
            for (angle, column) in angles.iter_mut().zip(&mut joint) {
                *angle = 0.6 * random.normal_within(2.0);
                column.push(*angle);
            }
            evaluation.move_to(&angles)?;
            let distance_m = evaluation.pose()?.position_m.norm();
            distances_m.push(distance_m + SD_M * random.normal());
        }
        Ok(Recording {
            line: (2..).take(poses).collect(),
            output: vec![None; joint.len()],
            torque_nm: vec![None; joint.len()],
            cable_m: vec![Some(distances_m)],
            joint,
            ..Recording::default()
        })
    }

    /// The problem of identifying the parameters from the distances.
    pub(crate) fn problem<'a>(&'a self, recording: &'a Recording) -> Result<DeviceProblem<'a>> {
        let channels = [Channel::Cable { index: 0 }];
        let weights = Weights::stated(&self.nominal, &channels);
        let (device, free) = (&self.nominal, &self.free);
        Ok(DeviceProblem::new(
            device, recording, &channels, free, &weights,
        )?)
    }
}
