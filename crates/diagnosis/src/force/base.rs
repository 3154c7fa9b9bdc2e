//! The base model of the torques: inertial parameters of all links, and what is not exactly known
//! beside them - each torque's scale, the geometry within its tolerance, a delay of the encoders.

use nalgebra::Vector3;

use super::along::Along;
use super::normal::Normal;
use super::posture::PER_LINK;
use super::recorded::Besides;
use super::weights::Weights;

/// Delay of the encoders against the torques \[s\].
const DELAY_SD_S: f64 = 2e-2;
/// Rounds in which the scales' columns settle; each leaves the square of a scale's error.
const ROUNDS: usize = 2;
/// Smallest uncertainty of a torque's scale.
const LEAST_SCALE_SD: f64 = 1e-4;

/// The base model fitted.
#[derive(Debug)]
pub(super) struct Base<'w> {
    pub(super) normal: Normal<'w>,
    /// First column of the torque scales, one per channel, after the inertial parameters.
    pub(super) scales: usize,
    /// Columns of the geometry.
    pub(super) geometry: std::ops::Range<usize>,
    /// Inertial parameters of all links.
    pub(super) inertia: Vec<f64>,
    /// Torques of the drives by the base model, channel after channel.
    pub(super) torque_nm: Vec<f64>,
    /// Force of the hand, per half block: as recorded, or as the torques have it.
    force_n: Vec<Vector3<f64>>,
}

impl Along<'_> {
    /// Fits the base model; where a force of the hand is free, that force first.
    pub(super) fn fit<'w>(&self, weights: &'w Weights, besides: Besides) -> Base<'w> {
        let bare = self
            .inertia
            .iter()
            .map(|column| (column.clone(), 0.0))
            .collect();
        let first = Normal::new(weights, &self.reading, bare);
        let inertia = self.all_parameters(first.solution.as_slice());
        let mut force_n = self.force_n.clone();
        if matches!(besides, Besides::Hand(_)) || self.recorded.force_n.is_none() {
            let rest = self.rest(&first);
            for (block, (unseen, _)) in self.hand_force(weights, &rest).iter().enumerate() {
                force_n[2 * block] -= unseen;
                force_n[2 * block + 1] -= unseen;
            }
        }
        drop(first);
        let torque_nm = self.drive_torques(&inertia, &force_n);
        let mut columns: Vec<(Vec<f64>, f64)> = self
            .inertia
            .iter()
            .map(|column| (column.clone(), 0.0))
            .collect();
        let scales = columns.len();
        let device = self.recorded.context.device;
        for (channel, &joint) in self.recorded.channels.iter().enumerate() {
            let sd = device.joints[joint].torque_scale_sd.max(LEAST_SCALE_SD);
            columns.push((self.only(channel, &torque_nm), 1.0 / (sd * sd)));
        }
        let first = columns.len();
        columns.extend(self.geometry(&inertia, &force_n));
        let geometry = first..columns.len();
        columns.push((
            self.delayed(&inertia, &force_n),
            1.0 / (DELAY_SD_S * DELAY_SD_S),
        ));
        let mut base = Base {
            normal: Normal::new(weights, &self.reading, columns),
            scales,
            geometry,
            inertia,
            torque_nm,
            force_n,
        };
        self.settle(&mut base);
        base
    }

    /// The torques that the scales multiply are the model's own: takes them from the solution.
    pub(super) fn settle(&self, base: &mut Base<'_>) {
        for _ in 0..ROUNDS {
            base.inertia = self.all_parameters(&base.normal.solution.as_slice()[..base.scales]);
            base.torque_nm = self.drive_torques(&base.inertia, &base.force_n);
            let own = (0..self.recorded.channels.len())
                .map(|channel| self.only(channel, &base.torque_nm))
                .collect();
            base.normal.replace(base.scales, own);
        }
    }

    /// Reading less what a solution says of it.
    pub(super) fn rest(&self, normal: &Normal<'_>) -> Vec<f64> {
        let fitted = normal.fitted();
        self.reading
            .iter()
            .zip(&fitted)
            .map(|(read, fitted)| read - fitted)
            .collect()
    }

    fn all_parameters(&self, solution: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; PER_LINK * self.recorded.context.device.joints.len()];
        for (&parameter, &value) in self.parameters.iter().zip(solution) {
            all[parameter] = value;
        }
        all
    }
    /// Torque of the drives: that of the links less that of the hand.
    fn drive_torques(&self, inertia: &[f64], force_n: &[Vector3<f64>]) -> Vec<f64> {
        let hand = self.hand_column(|half, _| force_n[half]);
        let mut torque = self.link_torques(inertia);
        for (torque, hand) in torque.iter_mut().zip(&hand) {
            *torque -= hand;
        }
        torque
    }

    fn only(&self, channel: usize, values: &[f64]) -> Vec<f64> {
        let blocks = self.recorded.blocks.len();
        let mut column = vec![0.0; values.len()];
        let range = channel * blocks..(channel + 1) * blocks;
        column[range.clone()].copy_from_slice(&values[range]);
        column
    }
}
