//! The base model of the torques: inertial parameters of all links, and what is not exactly known
//! in addition: each torque's scale, the geometry within its tolerance, a delay of the encoders.

use std::ops::Range;

use nalgebra::Vector3;

use super::Means;
use super::along::Along;
use super::assumed::with_assumed;
use super::recorded::Besides;
use super::rows::{FastRows, TorqueRows};
use crate::engine::{Regression, SlowEnergy, dot};
use crate::select::{Candidate, Score};
use crate::thresholds::torque::{KNOWN_BEFOREHAND, SCALE_ROUNDS};

/// The base model fitted, with effects.
#[derive(Debug, Clone)]
pub(super) struct Base {
    /// The links' columns first, one for each inertial number.
    pub(super) regression: Regression<TorqueRows>,
    pub(super) geometry: Range<usize>,
    /// Columns of the torque scales, one per channel, after all others of the base model.
    pub(super) scales: Range<usize>,
    /// Inertial parameters of all links.
    pub(super) inertia: Vec<f64>,
    /// Those at which the columns of the geometry and of the delay are taken.
    pub(super) linearised_at: Vec<f64>,
    /// Torques of the drives by the base model.
    pub(super) torque_nm: Means,
    /// Force of the hand, per half block: as recorded, or as the torques have it.
    force_n: Vec<Vector3<f64>>,
}

impl Base {
    /// Takes up a column that is known to be `sd` about zero, infinite for not at all.
    fn add_known(&mut self, means: &Means, sd: f64) {
        let rows = &self.regression.system.layout;
        let row = rows.prior(self.regression.len());
        let mut column = rows.of_means(means);
        let prior = 1.0 / (sd * sd);
        let square = prior + KNOWN_BEFOREHAND * (dot(&column, &column) + prior);
        column[row] = if square > 0.0 { square.sqrt() } else { 1.0 };
        self.regression.add(column);
    }

    /// Adds what changes within blocks.
    pub(super) fn append(&mut self, fast: Vec<FastRows>) {
        let reading = self.regression.system.layout.append(fast);
        self.regression.append(&reading);
    }

    /// Adds the columns of effects.
    pub(super) fn adopt(&mut self, columns: &[Vec<f64>]) {
        let columns = columns.iter().cloned();
        columns.for_each(|column| self.regression.add(column));
    }

    /// What columns of an effect at a shape explain in addition to the model.
    pub(super) fn score(&self, columns: &[Vec<f64>], effect: usize, shape: f64) -> Score {
        let candidate = self.candidate(columns, effect, shape);
        candidate.score(&self.regression.system)
    }

    /// Columns of an effect at a shape, with their projection on the model.
    pub(super) fn candidate(&self, columns: &[Vec<f64>], effect: usize, shape: f64) -> Candidate {
        let system = &self.regression.system;
        let columns = columns.iter().map(|column| system.layout.split(column));
        Candidate::of_columns(system, columns.collect(), effect, shape)
    }

    /// What the model leaves of the block means.
    pub(super) fn rest(&self) -> Means {
        let system = &self.regression.system;
        system.layout.means(&system.residual)
    }

    /// Mean square of the changes that the torques ask of the geometry's numbers, each over its tolerance.
    pub(super) fn strain(&self) -> f64 {
        let system = &self.regression.system;
        let pull = |index| system.residual[system.layout.prior(index)];
        let square: f64 = self.geometry.clone().map(|index| pull(index).powi(2)).sum();
        square / self.geometry.len().max(1) as f64
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
    /// Fits the base model, after the hand's force where that is free; none where the torques have no noise at all.
    pub(super) fn fit(&self, besides: Besides) -> Option<Base> {
        let whitener = self.whitener(besides)?;
        let links = self.inertia.len();
        let geometry = links..links + self.geometry_sds().len();
        // the delay's column follows the geometry's
        let scales = geometry.end + 1..geometry.end + 1 + self.recorded.channels.len();
        let rows = TorqueRows::new(whitener.clone(), self.recorded.shape(), scales.end);
        let windows = self.recorded.windows();
        let mut reading = whitener.whiten(&self.reading).as_slice().to_vec();
        reading.resize(reading.len() + scales.end, 0.0);
        let mut base = Base {
            regression: Regression::new(rows, windows, reading),
            geometry,
            scales,
            inertia: Vec::new(),
            linearised_at: Vec::new(),
            torque_nm: Means::zeros(0, 0),
            force_n: self.force_n.clone(),
        };
        for column in &self.inertia {
            base.add_known(column, f64::INFINITY);
        }
        base.linearised_at = with_assumed(self, &base.regression);
        if matches!(besides, Besides::Hand(_)) || self.recorded.is_held {
            let unseen = self.hand_force(&whitener, &base.rest());
            for (half, force) in base.force_n.iter_mut().enumerate() {
                *force -= unseen[half / 2].0;
            }
        }
        for (column, sd) in self.geometry(&base.linearised_at, &base.force_n) {
            base.add_known(&column, sd);
        }
        self.settle(&mut base);
        Some(base)
    }

    /// The torques that the scales multiply are the model's own: takes them from the solution.
    pub(super) fn settle(&self, base: &mut Base) {
        for _ in 0..=SCALE_ROUNDS {
            base.inertia = base.regression.solution()[..self.inertia.len()].to_vec();
            base.torque_nm = self.drive_torques(&base.inertia, &base.force_n);
            let behind = base.regression.truncate(base.scales.start);
            for (channel, sd) in self.scale_sds().into_iter().enumerate() {
                let torque_nm = base.torque_nm.column(channel).into_owned();
                base.add_known(&self.recorded.on(channel, torque_nm.as_slice()), sd);
            }
            let effects = behind.into_iter().skip(base.scales.len());
            effects.for_each(|column| base.regression.add(column));
        }
    }

    /// Columns of this recording for the numbers of a base model of another one.
    pub(super) fn columns_of(&self, first: &Along<'_>, base: &Base) -> Vec<Means> {
        let mut columns = self.inertia.clone();
        let geometry = self.geometry(&base.linearised_at, &self.force_n);
        columns.extend(geometry.into_iter().map(|(column, _)| column));
        let drives = self.drive_torques(&base.inertia, &self.force_n);
        columns.extend(first.recorded.channels.iter().map(|&joint| {
            match self.recorded.channel(joint) {
                Some(channel) => (self.recorded).on(channel, drives.column(channel).as_slice()),
                None => drives.map(|_| 0.0),
            }
        }));
        columns
    }
}
