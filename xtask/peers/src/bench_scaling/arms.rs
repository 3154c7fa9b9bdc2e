//! Arms of any number of joints, with poses and distances made by formula.

use anyhow::Result;
use haptical_batch::{DistanceModel, PoseBatch, Sines};
use haptical_model::kinematics::{Chain, Convention, Link, Motion, distance_m};
use xtask_blind::Random;

/// Standard deviation of a distance \[m\], the paper's.
const SD_M: f64 = 9.87e-6;

/// An arm a little off its nominal values.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) model: DistanceModel,
    truth: Vec<Link>,
    motions: Vec<Motion>,
    /// Parameters that distances can fix: all but alpha, d and theta of the first row and the last alpha.
    pub(crate) free: Vec<usize>,
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
        let mut motions = vec![Motion::Revolute; joints + 1];
        motions[0] = Motion::Fixed;
        let last_twist = 4 * joints + 1;
        let free: Vec<usize> = (0..4 * (joints + 1))
            .filter(|index| ![1, 2, 3, last_twist].contains(index))
            .collect();
        let mut truth = nominal.clone();
        for &index in &free {
            let link = &mut truth[index / 4];
            let off = 1e-3 * random.normal();
            match index % 4 {
                0 => link.a_m += off,
                1 => link.alpha_rad += off,
                2 => link.d_m += off,
                _ => link.theta_rad += off,
            }
        }
        let model = DistanceModel::new(Convention::Standard, &nominal, &motions, [0.0; 3])?;
        Ok(Self {
            model,
            truth,
            motions,
            free,
        })
    }

    /// Hands `poses` poses to `each`: joint angles \[rad\] and the measured distance \[m\].
    pub(crate) fn record(
        &self,
        poses: usize,
        seed: u64,
        mut each: impl FnMut(&[f64], f64) -> Result<()>,
    ) -> Result<()> {
        let chain = Chain::new(Convention::Standard, &self.truth, &self.motions)?;
        let mut random = Random::new(seed, 1);
        let mut angles = vec![0.0; self.motions.len() - 1];
        for _ in 0..poses {
            for angle in &mut angles {
                *angle = 0.6 * random.normal_within(2.0);
            }
            let pose = chain.pose(&angles)?;
            let distance = distance_m(&pose.position_m, &[0.0; 3].into())?;
            each(&angles, distance + SD_M * random.normal())?;
        }
        Ok(())
    }

    /// The poses in memory.
    pub(crate) fn batch(&self, poses: usize, seed: u64) -> Result<PoseBatch> {
        let mut joints = vec![Vec::with_capacity(poses); self.motions.len() - 1];
        let mut distances_m = Vec::with_capacity(poses);
        self.record(poses, seed, |angles, distance| {
            for (joint, angle) in joints.iter_mut().zip(angles) {
                joint.push(*angle);
            }
            distances_m.push(distance);
            Ok(())
        })?;
        let weights = vec![weight(); poses];
        let sines = Sines::Cached;
        Ok(PoseBatch::new(
            &self.motions,
            &joints,
            &distances_m,
            &weights,
            sines,
        )?)
    }
}

/// One over the standard deviation of a distance \[1/m\].
pub(crate) fn weight() -> f64 {
    1.0 / SD_M
}
