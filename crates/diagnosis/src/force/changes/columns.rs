//! Columns that runs are compared with: what both sides share, what a payload adds, and what else may have changed.

use std::ops::Range;

use haptical_model::dynamics::Inertia;
use haptical_model::kinematics::Pose;

use super::blocks::Pair;
use crate::force::Means;
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{COMMON_DEGREE, SLOW};

/// Columns of a comparison, by what they stand for.
#[derive(Debug, Default)]
pub(in crate::force) struct Columns {
    /// Over the blocks compared.
    pub(super) all: Vec<Means>,
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

    /// Of the rigid links with what is not exactly known of them.
    pub(in crate::force) fn of_links(along: &Along<'_>, base: &Base, pair: &Pair) -> Self {
        let mut columns = Self::default();
        for column in &along.inertia {
            columns.add(pair.common(column), f64::INFINITY);
        }
        for (column, sd) in along.geometry(&base.linearised_at, &along.force_n) {
            columns.add(pair.common(&column), sd);
        }
        columns
    }

    pub(in crate::force) fn len(&self) -> usize {
        self.all.len()
    }

    pub(in crate::force) fn add(&mut self, column: Means, sd: f64) -> usize {
        self.all.push(column);
        self.sd.push(sd);
        self.all.len() - 1
    }

    /// The links, and free functions of each joint's own state.
    fn share(&mut self, along: &Along<'_>, base: &Base, pair: &Pair) {
        *self = Self::of_links(along, base, pair);
        let ranges = along.ranges();
        for (channel, &joint) in along.recorded.channels.iter().enumerate() {
            let mut add = |values: &[f64]| {
                let own = pair.common(&along.recorded.on(channel, values));
                self.add(own, f64::INFINITY)
            };
            let angle = along.angle.column(joint);
            let (middle, half) = (angle.mean(), (0.5 * ranges[joint]).max(1e-12));
            for degree in 0..=COMMON_DEGREE {
                let power = angle.map(|angle| ((angle - middle) / half).powi(degree));
                add(power.as_slice());
            }
            let [side, rate] = friction(along, joint);
            let torque = base.torque_nm.column(channel);
            let load = torque.iter().zip(&side);
            let load = load.map(|(torque, side)| torque.abs() * side);
            for values in [&side, &rate, &load.collect()] {
                add(values);
            }
        }
    }

    /// What may have changed of a drive alone.
    fn change(&mut self, along: &Along<'_>, base: &Base, pair: &Pair) {
        let recorded = &along.recorded;
        let gained = pair.gained(along, &base.torque_nm);
        for (channel, &joint) in recorded.channels.iter().enumerate() {
            let mut add = |values: &[f64]| {
                let own = pair.later(&recorded.on(channel, values));
                self.add(own, f64::INFINITY)
            };
            let offset = add(&vec![1.0; recorded.blocks.len()]);
            let friction = friction(along, joint).map(|values| add(&values));
            let mut own = gained.map(|_| 0.0);
            own.set_column(channel, &gained.column(channel));
            let gain = self.add(own, f64::INFINITY);
            self.own.push(Own {
                offset,
                friction: friction[0]..friction[1] + 1,
                gain,
            });
        }
    }

    /// What another mass on each link adds, and one at the flange.
    fn carry(&mut self, along: &Along<'_>, pair: &Pair) {
        self.links = vec![Vec::new(); along.joints()];
        for (number, column) in along.inertia.iter().enumerate() {
            let index = self.add(pair.later(column), f64::INFINITY);
            // no rotor is put on a link
            let link = self.links.get_mut(number / PER_LINK);
            if let Some(link) = link.filter(|_| column.amax() > 0.0) {
                link.push((index, number % PER_LINK));
            }
        }
        let first = self.all.len();
        for numbers in flange(along) {
            let column = along.link_torques(&numbers);
            self.add(pair.later(&column), f64::INFINITY);
        }
        self.flange = first..self.all.len();
    }

    /// Every drive's change of some kind.
    pub(super) fn every(&self, kind: impl Fn(&Own) -> Vec<usize>) -> Vec<usize> {
        self.own.iter().flat_map(kind).collect()
    }
}

/// Inertial numbers of an arm that carries nothing but what hangs at its flange: one kilogram there, a unit of its first moments about
/// there along each axis, and its inertia.
pub(in crate::force) fn flange(along: &Along<'_>) -> [Vec<f64>; PER_LINK] {
    let place = Pose {
        position_m: along.flange_m(),
        ..Pose::default()
    };
    std::array::from_fn(|number| {
        let mut unit = [0.0; PER_LINK];
        unit[number] = 1.0;
        let seen = Inertia::from_parameters(unit).seen_from(&place);
        let mut all = vec![0.0; PER_LINK * (along.joints() - 1)];
        all.extend(seen.parameters());
        all
    })
}

/// Dry and viscous friction of a joint: the side on which the first is, -1 to 1, turns over within a part of the joint's usual rate.
fn friction(along: &Along<'_>, joint: usize) -> [Vec<f64>; 2] {
    let rate = along.rate.column(joint);
    let turn = (SLOW * rate.norm() / (rate.len().max(1) as f64).sqrt()).max(1e-12);
    [rate.map(|rate| (rate / turn).tanh()), rate.into_owned()].map(|own| own.as_slice().to_vec())
}
