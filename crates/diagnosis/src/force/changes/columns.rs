//! Columns that runs are compared with: what both sides share, what a payload adds, and what else may have changed.

use std::ops::Range;

use haptical_model::dynamics::Inertia;
use haptical_model::kinematics::Pose;
use nalgebra::Vector3;

use super::blocks::Pair;
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{COMMON_DEGREE, SLOW};
use crate::thresholds::torque::DELAY_SD_S;

/// A column, channel after channel over the blocks compared; nothing in the channels that it does not touch.
pub(in crate::force) type Column = Vec<Option<Vec<f64>>>;

/// Columns of a comparison, by what they stand for.
#[derive(Debug, Default)]
pub(in crate::force) struct Columns {
    pub(in crate::force) all: Vec<Column>,
    /// Standard deviation about zero that a number is known to have; infinite for none.
    pub(super) sd: Vec<f64>,
    /// What both sides share; empty where one repeats the other.
    pub(super) common: Range<usize>,
    /// For each joint what its own torque may have changed by: an offset, friction, a gain.
    pub(super) own: Vec<Own>,
    /// For each link the numbers that another mass on it changes, with their places among its ten.
    pub(super) links: Vec<Vec<(usize, usize)>>,
    /// One kilogram at the flange, its first moments about there, and its inertia.
    pub(super) flange: Range<usize>,
}

/// Columns of one drive's change.
#[derive(Debug, Clone)]
pub(in crate::force) struct Own {
    pub(super) offset: usize,
    pub(super) friction: Range<usize>,
    pub(super) gain: usize,
}

impl Own {
    pub(super) fn all(&self) -> Vec<usize> {
        let mut all = vec![self.offset, self.gain];
        all.extend(self.friction.clone());
        all
    }
}

impl Columns {
    pub(super) fn new(along: &Along<'_>, base: &Base, pair: &Pair) -> Self {
        let mut columns = Self::default();
        if pair.twin.is_none() {
            columns.share(along, base, pair);
        }
        columns.common = 0..columns.all.len();
        columns.change(along, base, pair);
        columns.carry(along, pair);
        columns
    }

    pub(in crate::force) fn add(&mut self, column: Column, sd: f64) -> usize {
        self.all.push(column);
        self.sd.push(sd);
        self.all.len() - 1
    }

    /// The rigid links with what is not exactly known of them, and free functions of each joint's own state.
    fn share(&mut self, along: &Along<'_>, base: &Base, pair: &Pair) {
        let recorded = along.recorded;
        let dense = |column: &[f64]| -> Column {
            let blocks = recorded.blocks.len();
            let own = column.chunks_exact(blocks);
            own.map(|own| Some(pair.common(own))).collect()
        };
        for column in &along.inertia {
            self.add(dense(column), f64::INFINITY);
        }
        let geometry = along.geometry(&base.linearised_at, &along.force_n);
        for (column, sd) in geometry.iter().zip(along.geometry_sds()) {
            self.add(dense(column), sd);
        }
        self.add(
            dense(&along.delayed(&base.linearised_at, &along.force_n)),
            DELAY_SD_S,
        );
        let ranges = along.ranges();
        for (channel, &joint) in recorded.channels.iter().enumerate() {
            let own =
                |values: Vec<f64>| only(recorded.channels.len(), channel, pair.common(&values));
            let angles: Vec<f64> = along.angles(joint);
            let middle = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
            let half = (0.5 * ranges[joint]).max(1e-12);
            for degree in 0..=COMMON_DEGREE {
                let power = |angle: &f64| ((angle - middle) / half).powi(degree);
                self.add(own(angles.iter().map(power).collect()), f64::INFINITY);
            }
            for values in friction(along, joint) {
                self.add(own(values), f64::INFINITY);
            }
            let side = sides(along, joint);
            let torque = torque_of(along, base, channel).iter();
            let load = torque.zip(&side).map(|(torque, side)| torque.abs() * side);
            self.add(own(load.collect()), f64::INFINITY);
        }
    }

    /// What may have changed of a drive alone.
    fn change(&mut self, along: &Along<'_>, base: &Base, pair: &Pair) {
        let channels = along.recorded.channels.len();
        for (channel, &joint) in along.recorded.channels.iter().enumerate() {
            let own = |values: &[f64]| only(channels, channel, pair.later(values));
            let ones = vec![1.0; along.recorded.blocks.len()];
            let offset = self.add(own(&ones), f64::INFINITY);
            let first = self.all.len();
            for values in friction(along, joint) {
                self.add(own(&values), f64::INFINITY);
            }
            let friction = first..self.all.len();
            let gained = pair.gained(along, channel, torque_of(along, base, channel));
            let gain = self.add(only(channels, channel, gained), f64::INFINITY);
            self.own.push(Own {
                offset,
                friction,
                gain,
            });
        }
    }

    /// What another mass on each link adds, and one at the flange.
    fn carry(&mut self, along: &Along<'_>, pair: &Pair) {
        let joints = along.recorded.context.device.joints.len();
        let blocks = along.recorded.blocks.len();
        let later = |column: &[f64]| -> Column {
            let own = column.chunks_exact(blocks);
            own.map(|own| Some(pair.later(own))).collect()
        };
        self.links = vec![Vec::new(); joints];
        for (&parameter, column) in along.parameters.iter().zip(&along.inertia) {
            let index = self.add(later(column), f64::INFINITY);
            // no rotor is put on a link
            if let Some(link) = self.links.get_mut(parameter / PER_LINK) {
                link.push((index, parameter % PER_LINK));
            }
        }
        let first = self.all.len();
        for numbers in flange(&along.flange_m()) {
            self.add(later(&of_last_link(along, &numbers)), f64::INFINITY);
        }
        self.flange = first..self.all.len();
    }

    /// Every drive's change of some kind.
    pub(super) fn every(&self, kind: impl Fn(&Own) -> Vec<usize>) -> Vec<usize> {
        self.own.iter().flat_map(kind).collect()
    }
}

/// Torques of inertial numbers of the last link.
pub(super) fn of_last_link(along: &Along<'_>, numbers: &[f64; PER_LINK]) -> Vec<f64> {
    let joints = along.recorded.context.device.joints.len();
    let mut sum = vec![0.0; along.recorded.len()];
    for (number, factor) in numbers.iter().enumerate() {
        let Some(column) = along.column_of(PER_LINK * (joints - 1) + number) else {
            continue;
        };
        for (sum, value) in sum.iter_mut().zip(column) {
            *sum += factor * value;
        }
    }
    sum
}

/// Inertial numbers of what hangs at a place of the last link: one kilogram there, a unit of its first moments about
/// there along each axis, and its inertia.
pub(super) fn flange(place_m: &Vector3<f64>) -> [[f64; PER_LINK]; PER_LINK] {
    let place = Pose {
        position_m: *place_m,
        ..Pose::default()
    };
    std::array::from_fn(|number| {
        let mut unit = [0.0; PER_LINK];
        unit[number] = 1.0;
        Inertia::from_parameters(unit)
            .seen_from(&place)
            .parameters()
    })
}

/// Nothing but one channel.
pub(in crate::force) fn only(channels: usize, channel: usize, values: Vec<f64>) -> Column {
    let mut column = vec![None; channels];
    column[channel] = Some(values);
    column
}

/// The model's torque of a channel, block by block.
fn torque_of<'b>(along: &Along<'_>, base: &'b Base, channel: usize) -> &'b [f64] {
    let blocks = along.recorded.blocks.len();
    &base.torque_nm[channel * blocks..(channel + 1) * blocks]
}

/// Side on which dry friction is, -1 to 1: it turns over within a part of the joint's usual rate.
fn sides(along: &Along<'_>, joint: usize) -> Vec<f64> {
    let rates = along.rates(joint);
    let square = rates.iter().map(|rate| rate * rate).sum::<f64>() / rates.len().max(1) as f64;
    let turn = (SLOW * square.sqrt()).max(1e-12);
    rates.iter().map(|rate| (rate / turn).tanh()).collect()
}

/// Dry and viscous friction of a joint.
fn friction(along: &Along<'_>, joint: usize) -> Vec<Vec<f64>> {
    vec![sides(along, joint), along.rates(joint)]
}
