//! Recordings along smooth motions and at random postures, with noise that has memory, drifts or is larger in a range.

use anyhow::Result;
use haptical_model::{Device, Recording};
use haptical_simulator::{Noise, simulate, true_poses};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::rigs::{Rig, TRACKER_SD_M, generator, with_noise};

/// How the joints move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// Sums of two to four sines of one to three periods over the log.
    Smooth,
    /// Independent postures, row by row.
    Random,
}

/// Noise of every channel, of the stated size where nothing else is said.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Condition {
    pub(super) name: &'static str,
    /// Correlation of successive rows: AR(1).
    pub(super) correlation: f64,
    /// Change over the log, in standard deviations, with either sign.
    pub(super) drift_sd: f64,
    /// Standard deviation in the upper 30 to 50 % of a random joint's range, over that in the rest; 1 or 0 for even noise.
    pub(super) uneven: f64,
}

/// A recording with noise of a condition on external encoders and distances or positions.
pub(super) fn record(
    truth: &Device,
    (rig, motion): (Rig, Motion),
    condition: Condition,
    rows: usize,
    seed: u64,
) -> Result<Recording> {
    let mut seen = simulate(truth, &with_noise(Noise::None), rows, seed)?;
    let mut random = generator(seed, 5);
    if motion == Motion::Smooth {
        for (joint, column) in truth.joints.iter().zip(&mut seen.joint) {
            *column = smooth(rows, joint.lower_rad, joint.upper_rad, &mut random);
        }
    }
    let poses = true_poses(truth, &seen)?;
    let (joints, cables) = (seen.joint.clone(), seen.cable_m.len());
    for (index, joint) in truth.joints.iter().enumerate() {
        let sd = joint.output_sd_rad();
        if let (Some(column), Some(sd)) = (&mut seen.output[index], sd) {
            let sizes = condition.sizes(&joints, Some(index), &mut random);
            let noise = condition.noise(&sizes, &mut random);
            for ((out, &reading), error) in column.iter_mut().zip(&joints[index]).zip(noise) {
                *out = reading + joint.error_rad(reading)? + sd * error;
            }
        }
    }
    match rig {
        Rig::Cable => {
            let sd = truth.cable_sd_m(0).unwrap_or(0.0);
            let sizes = condition.sizes(&joints, None, &mut random);
            let noise = condition.noise(&sizes, &mut random);
            let distances = poses.iter().zip(noise);
            let distances = distances.map(|(pose, error)| pose.position_m.norm() + sd * error);
            seen.cable_m[0] = Some(distances.collect());
        }
        Rig::Tracker => {
            let sizes = condition.sizes(&joints, None, &mut random);
            let mut axis = |axis: usize| -> Vec<f64> {
                let noise = condition.noise(&sizes, &mut random);
                let each = poses.iter().zip(noise);
                each.map(|(pose, error)| pose.position_m[axis] + TRACKER_SD_M * error)
                    .collect()
            };
            seen.position_m = Some([axis(0), axis(1), axis(2)]);
            seen.cable_m = vec![None; cables];
        }
    }
    Ok(seen)
}

fn smooth(rows: usize, lower: f64, upper: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let count = random.random_range(2..5);
    let waves: Vec<[f64; 3]> = (0..count)
        .map(|_| {
            [
                random.random_range(0.4..1.0),
                random.random_range(1.0..3.0),
                random.random_range(0.0..1.0),
            ]
        })
        .collect();
    let whole: f64 = waves.iter().map(|wave| wave[0]).sum();
    let (middle, half) = ((lower + upper) / 2.0, (upper - lower) / 2.0);
    let at = |row: usize| {
        let time = (row as f64 + 0.5) / rows as f64;
        let wave = |[size, periods, phase]: &[f64; 3]| {
            size * (std::f64::consts::TAU * (periods * time + phase)).sin()
        };
        middle + 0.9 * half * waves.iter().map(wave).sum::<f64>() / whole
    };
    (0..rows).map(at).collect()
}

impl Condition {
    /// Size of a channel's noise at every row; `own` is the joint that it may depend on.
    fn sizes(self, joints: &[Vec<f64>], own: Option<usize>, random: &mut ChaCha8Rng) -> Vec<f64> {
        let rows = joints.first().map_or(0, Vec::len);
        if self.uneven <= 1.0 {
            return vec![1.0; rows];
        }
        let joint = own.unwrap_or_else(|| random.random_range(0..joints.len()));
        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        let angle = |row: usize| sign * joints[joint][row];
        let least = (0..rows).map(angle).fold(f64::INFINITY, f64::min);
        let most = (0..rows).map(angle).fold(f64::NEG_INFINITY, f64::max);
        let from = least + random.random_range(0.5..0.7) * (most - least);
        let size = |row: usize| {
            // an edge of 2 % of the range
            let above = (angle(row) - from) / (0.02 * (most - least));
            self.uneven
                .powf(1.0 / (1.0 + (-above).clamp(-50.0, 50.0).exp()))
        };
        (0..rows).map(size).collect()
    }

    /// Errors of one axis in standard deviations.
    fn noise(self, sizes: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
        let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
        let mut last = normal(random);
        let fresh = (1.0 - self.correlation * self.correlation).sqrt();
        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        let mean_square = sizes.iter().map(|size| size * size).sum::<f64>() / sizes.len() as f64;
        let drift = sign * self.drift_sd * mean_square.sqrt();
        let mut errors = Vec::with_capacity(sizes.len());
        for (row, size) in sizes.iter().enumerate() {
            last = self.correlation * last + fresh * normal(random);
            let time = (row as f64 + 0.5) / sizes.len() as f64 - 0.5;
            errors.push(size * last + drift * time);
        }
        errors
    }
}
