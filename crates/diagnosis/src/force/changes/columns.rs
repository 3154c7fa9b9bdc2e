//! Two groups of runs side by side: their blocks, and the columns that these are compared with: what both sides share, what a payload adds,
//! and what else may have changed.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::force::Means;
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{COMMON_DEGREE, SAME_POSTURE, SLOW};

/// Columns of a comparison, by what they stand for.
#[derive(Debug, Default)]
pub(in crate::force) struct Columns {
    /// The columns, at the blocks that are compared.
    pub(super) all: Vec<Means>,
    /// Standard deviation about zero that a number is known to have; infinite for none.
    pub(super) sd: Vec<f64>,
    /// What both sides share; empty where one repeats the other.
    pub(super) common: Range<usize>,
    /// Columns by which each drive may have changed, kind by kind: an offset, friction, a gain.
    pub(super) drives: Vec<[Vec<usize>; 3]>,
    /// Where a mass may have been put: at the flange, and on each link.
    pub(super) places: Vec<Place>,
}

#[derive(Debug, Clone)]
pub(in crate::force) struct Place {
    /// The link; none at the flange.
    pub(super) link: Option<usize>,
    /// Columns of another mass there, each with its place among the mass's ten numbers. Those of the flange are about
    /// the flange.
    pub(super) numbers: Vec<(usize, usize)>,
    /// Columns of the scales through which the mass's torque is read; none before a fit.
    pub(super) scales: Vec<usize>,
}

impl Place {
    pub(super) fn columns(&self) -> Vec<usize> {
        self.numbers.iter().map(|(column, _)| *column).collect()
    }

    pub(super) fn all(&self) -> Vec<usize> {
        [self.columns(), self.scales.clone()].concat()
    }

    /// The column of one of the ten numbers.
    pub(super) fn column(&self, number: usize) -> Option<usize> {
        let mut numbers = self.numbers.iter();
        numbers
            .find(|(_, place)| *place == number)
            .map(|(column, _)| *column)
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

    /// Columns of the rigid links and of what is not exactly known of them.
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

    /// Adds the links, and free functions of each joint's angle, rate and load.
    fn share(&mut self, along: &Along<'_>, base: &Base, pair: &Pair) {
        *self = Self::of_links(along, base, pair);
        let ranges = along.ranges();
        for (channel, &joint) in along.recorded.channels.iter().enumerate() {
            let mut add = |values: &[f64]| {
                let column = pair.common(&along.recorded.on(channel, values));
                self.add(column, f64::INFINITY)
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
                let column = pair.later(&recorded.on(channel, values));
                self.add(column, f64::INFINITY)
            };
            let offset = add(&vec![1.0; recorded.blocks.len()]);
            let friction = friction(along, joint).map(|values| add(&values));
            let mut gain = gained.map(|_| 0.0);
            gain.set_column(channel, &gained.column(channel));
            let gain = self.add(gain, f64::INFINITY);
            self.drives
                .push([vec![offset], friction.to_vec(), vec![gain]]);
        }
    }

    /// Adds the columns of another mass at the flange and on each link.
    fn carry(&mut self, along: &Along<'_>, pair: &Pair) {
        let mut links = vec![Vec::new(); along.joints()];
        for (number, column) in along.inertia.iter().enumerate() {
            let index = self.add(pair.later(column), f64::INFINITY);
            // no rotor is put on a link
            let link = links.get_mut(number / PER_LINK);
            if let Some(link) = link.filter(|_| column.amax() > 0.0) {
                link.push((index, number % PER_LINK));
            }
        }
        let at_flange = (0..PER_LINK).map(|number| {
            let mut unit = [0.0; PER_LINK];
            unit[number] = 1.0;
            let column = along.link_torques(&along.carrying(None, unit));
            (self.add(pair.later(&column), f64::INFINITY), number)
        });
        let flange = (None, at_flange.collect());
        let links = links.into_iter().enumerate();
        let links = links.map(|(link, numbers)| (Some(link), numbers));
        let places = std::iter::once(flange).chain(links);
        let places = places.map(|(link, numbers)| Place {
            link,
            numbers,
            scales: Vec::new(),
        });
        self.places = places.collect();
    }

    /// Every drive's change of some kind.
    pub(super) fn every(&self, kind: usize) -> Vec<usize> {
        self.drives
            .iter()
            .flat_map(|kinds| kinds[kind].clone())
            .collect()
    }
}

/// Dry and viscous friction of a joint. The sign of the first, -1 to 1, changes within a fraction of the joint's
/// usual rate.
fn friction(along: &Along<'_>, joint: usize) -> [Vec<f64>; 2] {
    let rate = along.rate.column(joint);
    let turn = (SLOW * rate.norm() / (rate.len().max(1) as f64).sqrt()).max(1e-12);
    [rate.map(|rate| (rate / turn).tanh()), rate.into_owned()]
        .map(|values| values.as_slice().to_vec())
}

/// Blocks before a change and after it.
#[derive(Debug)]
pub(in crate::force) struct Pair {
    /// Those compared: of a repeated trajectory the later ones alone.
    blocks: Vec<usize>,
    /// For each block the earlier one that it repeats; none where the trajectories differ.
    pub(super) twin: Option<Vec<usize>>,
    /// What is to be explained, a row for each of the blocks.
    pub(super) reading: Means,
    /// All blocks from the change on, to the end of the recording.
    pub(super) from: usize,
}

impl Pair {
    /// All blocks on one side.
    pub(in crate::force) fn whole(along: &Along<'_>) -> Self {
        let count = along.recorded.blocks.len();
        Self::of(along, (0..count).collect(), None, count)
    }

    /// Of a repeated trajectory the readings themselves are compared: a model whose ill-determined numbers multiply the
    /// noise of two accelerations would add its own.
    pub(super) fn new(along: &Along<'_>, before: Range<usize>, after: Range<usize>) -> Self {
        let from = after.start;
        match twins(along, &before, &after) {
            Some((blocks, twin)) => Self::of(along, blocks, Some(twin), from),
            None => Self::of(along, before.chain(after).collect(), None, from),
        }
    }

    fn of(along: &Along<'_>, blocks: Vec<usize>, twin: Option<Vec<usize>>, from: usize) -> Self {
        let mut reading = along.reading.select_rows(&blocks);
        if let Some(twin) = &twin {
            reading -= along.reading.select_rows(twin);
        }
        Self {
            blocks,
            twin,
            reading,
            from,
        }
    }

    /// Whether each of the blocks is after the change.
    pub(super) fn is_after(&self) -> impl Iterator<Item = bool> {
        self.blocks.iter().map(|&block| block >= self.from)
    }

    /// A column of all blocks, at the blocks that are compared.
    pub(super) fn common(&self, column: &Means) -> Means {
        column.select_rows(&self.blocks)
    }

    /// The same from the change on alone.
    pub(super) fn later(&self, column: &Means) -> Means {
        let mut later = self.common(column);
        for (mut row, is_after) in later.row_iter_mut().zip(self.is_after()) {
            row *= f64::from(u8::from(is_after));
        }
        later
    }

    /// Torques that other gains of the drives scale from the change on: of a repeated trajectory those that were read
    /// before, else the model's.
    pub(super) fn gained(&self, along: &Along<'_>, model_nm: &Means) -> Means {
        match &self.twin {
            Some(twin) => along.reading.select_rows(twin),
            None => self.later(model_nm),
        }
    }
}

/// Later blocks, each with the block at the same place of the run before, where the postures agree; none where the
/// trajectories differ.
fn twins(
    along: &Along<'_>,
    before: &Range<usize>,
    after: &Range<usize>,
) -> Option<(Vec<usize>, Vec<usize>)> {
    let recorded = &along.recorded;
    let place = |block: usize| {
        let row = recorded.blocks[block].rows.start;
        let run = recorded.context.runs.iter().find(|run| run.contains(&row));
        let start = run.map_or(0, |run| run.start);
        (start, row - start)
    };
    let last = place(before.end - 1).0;
    let of_last = before.clone().filter(|block| place(*block).0 == last);
    let earlier = of_last.map(|block| (place(block).1, block));
    let earlier: BTreeMap<usize, usize> = earlier.collect();
    let ranges = along.ranges();
    let is_same = |(block, twin): &(usize, usize)| {
        let off = along.angle.row(*block) - along.angle.row(*twin);
        let mut off = off.iter().zip(&ranges);
        off.all(|(off, range)| off.abs() <= SAME_POSTURE * range.max(1e-12))
    };
    let paired = |block: usize| Some((block, *earlier.get(&place(block).1)?));
    let pairs = after.clone().filter_map(paired);
    let (blocks, twin): (Vec<usize>, Vec<usize>) = pairs.filter(is_same).unzip();
    (5 * blocks.len() >= 4 * after.len()).then_some((blocks, twin))
}
