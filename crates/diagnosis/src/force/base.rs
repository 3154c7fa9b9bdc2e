//! The base model of the torques: inertial parameters of all links, and what is not exactly known
//! in addition: each torque's scale, the geometry within its tolerance, a delay of the encoders.

use std::ops::Range;

use nalgebra::Vector3;

use super::along::{Along, numbers};
use super::assumed::with_assumed;
use super::recorded::Besides;
use super::rows::whitener::Whitener;
use super::rows::{FastRows, TorqueRows};
use crate::engine::regression::Regression;
use crate::engine::system::{Column, SlowEnergy, dot};
use crate::select::scan::{Candidate, Score};
use crate::thresholds::torque::{DELAY_SD_S, KNOWN_BEFOREHAND, SCALE_ROUNDS};

/// The base model fitted, with effects.
#[derive(Debug, Clone)]
pub(super) struct Base {
    pub(super) regression: Regression<TorqueRows>,
    /// First column of the torque scales, one per channel, behind all others of the base model.
    pub(super) scales: usize,
    /// Columns of the geometry.
    pub(super) geometry: Range<usize>,
    /// Inertial parameters of all links.
    pub(super) inertia: Vec<f64>,
    /// Those at which the columns of the geometry and of the delay are taken.
    pub(super) linearised_at: Vec<f64>,
    /// Torques of the drives by the base model, channel after channel.
    pub(super) torque_nm: Vec<f64>,
    /// Force of the hand, per half block: as recorded, or as the torques have it.
    force_n: Vec<Vector3<f64>>,
}

impl Base {
    /// Takes up a column that is known to be `sd` about zero, infinite for not at all.
    fn add_known(&mut self, means: &[f64], sd: f64) {
        let rows = &self.regression.system.layout;
        let row = rows.prior(self.regression.len());
        let mut column = rows.whitener.whiten(means);
        let prior = 1.0 / (sd * sd);
        let square = prior + KNOWN_BEFOREHAND * (dot(&column, &column) + prior);
        column.resize(self.regression.reading().len(), 0.0);
        column[row] = if square > 0.0 { square.sqrt() } else { 1.0 };
        self.regression.add(column);
    }

    /// Adds what changes within blocks.
    pub(super) fn append(&mut self, fast: Vec<FastRows>) {
        let reading = self.regression.system.layout.append(fast);
        self.regression.append(&reading);
    }

    /// Column that sets a number of the base model free.
    pub(super) fn release(&self, index: usize) -> Column {
        let rows = &self.regression.system.layout;
        let weight = self.regression.column(index)[rows.prior(index)];
        rows.release(index, weight)
    }

    /// Takes up effects' columns.
    pub(super) fn adopt(&mut self, columns: &[Column]) {
        for column in columns {
            let dense = self.regression.system.dense(column);
            self.regression.add(dense);
        }
    }

    /// What some columns explain in addition to the model.
    pub(super) fn score(&self, columns: Vec<Column>) -> Score {
        let system = &self.regression.system;
        Candidate::of_columns(system, columns, 0, 0.0).score(system)
    }

    /// What the model leaves of the block means.
    pub(super) fn rest(&self) -> Vec<f64> {
        let system = &self.regression.system;
        let ends = system.layout.prior(0);
        system.layout.whitener.colour(&system.residual[..ends])
    }

    /// Squares of some entries of the solution over the variances of their priors.
    pub(super) fn strain(&self, columns: Range<usize>) -> f64 {
        let system = &self.regression.system;
        let rows = columns.map(|index| system.layout.prior(index));
        rows.map(|row| system.residual[row].powi(2)).sum()
    }

    /// Slow energy per channel. `free` directions of each window can take any torque, and carry no energy.
    pub(super) fn energy(&self, free: usize) -> Vec<SlowEnergy> {
        let system = &self.regression.system;
        let mut energy = system.slow_energy(&system.residual);
        let taken = free as f64 / energy.len() as f64 * system.windows(0) as f64;
        for own in &mut energy {
            own.freedom = (own.freedom - taken).max(0.0);
        }
        energy
    }

    /// Squares that effects explain within blocks.
    pub(super) fn explained_within_blocks(&self) -> f64 {
        let rows = self.regression.system.layout.within_blocks();
        let square = |all: &[f64]| dot(&all[rows.clone()], &all[rows.clone()]);
        (square(self.regression.reading()) - square(&self.regression.system.residual)).max(0.0)
    }
}

impl Along<'_> {
    /// Fits the base model; where a force of the hand is free, that force first.
    pub(super) fn fit(&self, whitener: &Whitener, besides: Besides) -> Base {
        let channels = self.recorded.channels.len();
        let geometry = self.parameters.len()..self.parameters.len() + self.geometry_sds().len();
        let scales = geometry.end + 1;
        let rows = TorqueRows::new(whitener.clone(), scales + channels);
        let mut reading = whitener.whiten(&self.reading);
        reading.resize(reading.len() + scales + channels, 0.0);
        let windows = rows.windows(&self.recorded.windows());
        let mut base = Base {
            regression: Regression::new(rows, windows, reading),
            scales,
            geometry,
            inertia: Vec::new(),
            linearised_at: Vec::new(),
            torque_nm: Vec::new(),
            force_n: self.force_n.clone(),
        };
        for column in &self.inertia {
            base.add_known(column, f64::INFINITY);
        }
        base.linearised_at = with_assumed(self, &base.regression);
        if matches!(besides, Besides::Hand(_)) || self.recorded.hand_is_unknown() {
            for (block, (unseen, _)) in self.hand_force(whitener, &base.rest()).iter().enumerate() {
                base.force_n[2 * block] -= unseen;
                base.force_n[2 * block + 1] -= unseen;
            }
        }
        let columns = self.geometry(&base.linearised_at, &base.force_n);
        for (column, sd) in columns.iter().zip(self.geometry_sds()) {
            base.add_known(column, sd);
        }
        base.add_known(
            &self.delayed(&base.linearised_at, &base.force_n),
            DELAY_SD_S,
        );
        self.settle(&mut base);
        base
    }

    /// The torques that the scales multiply are the model's own: takes them from the solution.
    pub(super) fn settle(&self, base: &mut Base) {
        let scale_sds = self.scale_sds();
        let blocks = self.recorded.blocks.len();
        for _ in 0..=SCALE_ROUNDS {
            base.inertia = self.all_parameters(&base.regression.solution());
            base.torque_nm = self.drive_torques(&base.inertia, &base.force_n);
            let behind = base.regression.truncate(base.scales);
            for (channel, &sd) in scale_sds.iter().enumerate() {
                let own = channel * blocks..(channel + 1) * blocks;
                base.add_known(&self.on(channel, &base.torque_nm[own]), sd);
            }
            let effects = behind.into_iter().skip(self.recorded.channels.len());
            effects.for_each(|column| base.regression.add(column));
        }
    }

    /// Block means of this recording by the model of another one with these coefficients.
    pub(super) fn predicted(&self, first: &Along<'_>, base: &Base, solution: &[f64]) -> Vec<f64> {
        let mut torque = self.link_torques(&first.all_parameters(solution));
        let mut add = |column: &[f64], factor: f64| {
            let pairs = torque.iter_mut().zip(column);
            pairs.for_each(|(sum, value)| *sum += factor * value);
        };
        let geometry = self.geometry(&base.linearised_at, &self.force_n);
        for (column, factor) in geometry.iter().zip(&solution[base.geometry.clone()]) {
            add(column, *factor);
        }
        add(
            &self.delayed(&base.linearised_at, &self.force_n),
            solution[base.geometry.end],
        );
        let drives = self.drive_torques(&base.inertia, &self.force_n);
        let blocks = self.recorded.blocks.len();
        for (channel, &joint) in self.recorded.channels.iter().enumerate() {
            let Some(own) = first.recorded.channel(joint) else {
                continue;
            };
            let means = &drives[channel * blocks..(channel + 1) * blocks];
            add(&self.on(channel, means), solution[base.scales + own]);
        }
        torque
    }

    /// Reading less what is left of it: what a model says of the block means.
    pub(super) fn less(&self, rest: &[f64]) -> Vec<f64> {
        let pairs = self.reading.iter().zip(rest);
        pairs.map(|(read, rest)| read - rest).collect()
    }

    pub(super) fn all_parameters(&self, solution: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; numbers(self.recorded.context.device.joints.len())];
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

    /// Block means of one channel, nothing elsewhere.
    pub(super) fn on(&self, channel: usize, means: &[f64]) -> Vec<f64> {
        let blocks = self.recorded.blocks.len();
        let mut all = vec![0.0; self.recorded.len()];
        all[channel * blocks..(channel + 1) * blocks].copy_from_slice(means);
        all
    }
}
