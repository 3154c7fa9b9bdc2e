//! How much an effect changes: the part of the logged torque that the same arm and controller without it do not explain.

use crate::moving::arms::Arm;
use crate::moving::laws::Sliding;
use crate::moving::motion::control::{Controller, Design, TICKS_PER_S};
use crate::moving::motion::log::Ticks;
use crate::moving::motion::plant::Plant;
use crate::moving::motion::rigid::At;
use crate::moving::motion::specimen::Specimen;

/// Corner of the filter through which both change and noise are seen \[Hz\].
const CORNER_HZ: f64 = 10.0;
/// Share of the rows that are changed at least as much as the stated peak.
const PEAK_SHARE: f64 = 0.02;

/// A change of torque, worst joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Change {
    /// Root mean square over the standard deviation of the noise, both filtered.
    pub(crate) over_noise: f64,
    /// What a fiftieth of the rows exceeds, over the range of the drive.
    pub(crate) of_range: f64,
}

impl Change {
    fn max(self, other: Self) -> Self {
        Self {
            over_noise: self.over_noise.max(other.over_noise),
            of_range: self.of_range.max(other.of_range),
        }
    }

    /// Of columns, joint by joint, sampled at `rate_hz`; `noise` is each joint's standard deviation per row.
    fn of(arm: &Arm, columns: &[Vec<f64>], rate_hz: f64, noise: &[f64]) -> Self {
        let kernel = kernel(rate_hz);
        let gain = libm::sqrt(kernel.iter().map(|weight| weight * weight).sum::<f64>());
        let mut worst = Self::default();
        for (joint, column) in columns.iter().enumerate() {
            let seen = filtered(column, &kernel);
            let rms = crate::laws::rms(&seen);
            let mut sizes: Vec<f64> = seen.iter().map(|value| value.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            let place = ((1.0 - PEAK_SHARE) * sizes.len() as f64) as usize;
            let peak = sizes.get(place).copied().unwrap_or(0.0);
            worst = worst.max(Self {
                over_noise: rms / (gain * noise[joint]),
                of_range: peak / arm.axes[joint].range,
            });
        }
        worst
    }
}

/// Against the rigid bodies and the friction, and against the controller's law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Changes {
    pub(crate) arm: Change,
    pub(crate) controller: Change,
}

/// Changes of a log, of which `rows` are the ticks that it shows; `plain` is the same arm without the effects.
pub(crate) fn changes(
    arm: &Arm,
    plain: &Specimen,
    design: &Design,
    ticks: &Ticks,
    rows: &[usize],
    rate_hz: f64,
    noise: &[f64],
) -> Changes {
    let pick = |columns: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        let of = |column: Vec<f64>| rows.iter().map(|row| column[*row]).collect();
        columns.into_iter().map(of).collect()
    };
    let left = pick(left_by_arm(plain, ticks));
    let unheard = pick(left_by_controller(design, ticks));
    Changes {
        arm: Change::of(arm, &left, rate_hz, noise),
        controller: Change::of(arm, &unheard, rate_hz, noise),
    }
}

/// Logged torque less what bodies, rotors and friction of the arm need along the logged motion.
fn left_by_arm(plain: &Specimen, ticks: &Ticks) -> Vec<Vec<f64>> {
    let joints = ticks.joints();
    let start: Vec<f64> = ticks.angle.iter().map(|column| column[0]).collect();
    let mut plant = Plant::new(plain, &[], &start);
    let mut at = At::default();
    let mut left = vec![Vec::with_capacity(ticks.len()); joints];
    for tick in 0..ticks.len() {
        let of = |columns: &[Vec<f64>]| -> Vec<f64> {
            columns.iter().map(|column| column[tick]).collect()
        };
        let (angle, rate, acceleration) =
            (of(&ticks.angle), of(&ticks.rate), of(&ticks.acceleration));
        plain.chain.at(&angle, &rate, &mut at);
        for joint in 0..joints {
            let sliding = Sliding {
                joint,
                time_s: ticks.time_s[tick],
                angle: angle[joint],
                speed: rate[joint],
                drive: ticks.torque[joint][tick],
            };
            let needed =
                at.needed(joint, &acceleration, plain.armature[joint]) + plant.friction(&sliding);
            plant.follow(joint, angle[joint]);
            left[joint].push(ticks.torque[joint][tick] - needed);
        }
    }
    left
}

/// Logged torque less what the controller's law makes of the logged command and angles.
fn left_by_controller(design: &Design, ticks: &Ticks) -> Vec<Vec<f64>> {
    let joints = ticks.joints();
    let mut controller = Controller::new(design);
    let (mut held, mut torque) = (vec![0.0; joints], vec![0.0; joints]);
    let mut left = vec![Vec::with_capacity(ticks.len()); joints];
    for tick in 0..ticks.len() {
        let read: Vec<f64> = ticks.angle.iter().map(|column| column[tick]).collect();
        controller.tick(&ticks.asked(tick), &read, [1.0; 2], &mut torque);
        for joint in 0..joints {
            let before = if tick == 0 {
                torque[joint]
            } else {
                held[joint]
            };
            left[joint].push(ticks.torque[joint][tick] - 0.5 * (before + torque[joint]));
        }
        held.copy_from_slice(&torque);
    }
    left
}

/// Weights of a Gaussian low pass that halves the power at the corner.
fn kernel(rate_hz: f64) -> Vec<f64> {
    // |H(f)|^2 = exp(-(2 pi f s)^2) = 1/2 at the corner
    let sd_s = libm::sqrt(std::f64::consts::LN_2) / (std::f64::consts::TAU * CORNER_HZ);
    let half = libm::ceil(4.0 * sd_s * rate_hz) as i32;
    let weight = |place: i32| {
        let x = f64::from(place) / rate_hz / sd_s;
        libm::exp(-0.5 * x * x)
    };
    let weights: Vec<f64> = (-half..=half).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// The column through the kernel, its ends left out.
fn filtered(column: &[f64], kernel: &[f64]) -> Vec<f64> {
    let dot = |rows: &[f64]| {
        rows.iter()
            .zip(kernel)
            .map(|(value, weight)| value * weight)
            .sum()
    };
    column.windows(kernel.len()).map(dot).collect()
}

/// Ticks of the controller between two rows at a rate.
pub(crate) fn every(rate_hz: f64) -> usize {
    (TICKS_PER_S / rate_hz) as usize
}
