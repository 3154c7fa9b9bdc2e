//! Two groups of runs side by side: their blocks, and which of them repeat one another.

use std::ops::Range;

use crate::force::along::Along;
use crate::thresholds::payload::SAME_POSTURE;

/// Blocks before a change and after it.
#[derive(Debug)]
pub(in crate::force) struct Pair {
    /// Those compared: of a repeated trajectory the later ones alone.
    pub(super) blocks: Vec<usize>,
    /// Whether a block lies after the change.
    pub(super) is_after: Vec<bool>,
    /// For each block the earlier one that it repeats; none where the trajectories differ.
    pub(super) twin: Option<Vec<usize>>,
    /// What is to be explained, channel after channel over [`Self::blocks`].
    pub(super) reading: Vec<Vec<f64>>,
    /// All blocks from the change on, to the end of the recording.
    pub(super) from: usize,
}

impl Pair {
    /// All blocks on one side.
    pub(in crate::force) fn whole(along: &Along<'_>) -> Self {
        let count = along.recorded.blocks.len();
        let channels = along.reading.chunks_exact(count);
        Self {
            blocks: (0..count).collect(),
            is_after: vec![false; count],
            twin: None,
            reading: channels.map(<[f64]>::to_vec).collect(),
            from: count,
        }
    }

    /// Of a repeated trajectory the readings themselves are compared: a model whose ill-determined numbers multiply the
    /// noise of two accelerations would add its own.
    pub(super) fn new(along: &Along<'_>, before: Range<usize>, after: Range<usize>) -> Self {
        let from = after.start;
        let count = along.recorded.blocks.len();
        let channels = 0..along.recorded.channels.len();
        match twins(along, &before, &after) {
            Some(pairs) => {
                let read = |channel: usize, block: usize| along.reading[channel * count + block];
                let difference = |channel: usize| {
                    let pairs = pairs.iter();
                    let change =
                        |&(own, twin): &(usize, usize)| read(channel, own) - read(channel, twin);
                    pairs.map(change).collect()
                };
                Self {
                    reading: channels.map(difference).collect(),
                    is_after: vec![true; pairs.len()],
                    blocks: pairs.iter().map(|pair| pair.0).collect(),
                    twin: Some(pairs.iter().map(|pair| pair.1).collect()),
                    from,
                }
            }
            None => {
                let blocks: Vec<usize> = before.clone().chain(after).collect();
                let own = |channel: usize| {
                    let blocks = blocks.iter();
                    blocks
                        .map(|block| along.reading[channel * count + block])
                        .collect()
                };
                Self {
                    reading: channels.map(own).collect(),
                    is_after: blocks.iter().map(|&block| block >= from).collect(),
                    blocks,
                    twin: None,
                    from,
                }
            }
        }
    }

    /// A column of all blocks, in the blocks compared; what both sides of a repeated trajectory share is gone.
    pub(super) fn common(&self, column: &[f64]) -> Vec<f64> {
        self.blocks.iter().map(|&block| column[block]).collect()
    }

    /// What a drive of another gain adds from the change on: a share of the torque that it had, which of a repeated trajectory is
    /// what was read, else the model's.
    pub(super) fn gained(&self, along: &Along<'_>, channel: usize, model_nm: &[f64]) -> Vec<f64> {
        let Some(twin) = &self.twin else {
            return self.later(model_nm);
        };
        let own = &along.reading[channel * model_nm.len()..];
        twin.iter().map(|&block| own[block]).collect()
    }

    /// The same from the change on alone.
    pub(super) fn later(&self, column: &[f64]) -> Vec<f64> {
        let blocks = self.blocks.iter().zip(&self.is_after);
        let value =
            |(&block, &is_after): (&usize, &bool)| if is_after { column[block] } else { 0.0 };
        blocks.map(value).collect()
    }
}

/// Each later block with the earlier one of the same place in its run, where the postures are the same; none where
/// the trajectories differ.
fn twins(
    along: &Along<'_>,
    before: &Range<usize>,
    after: &Range<usize>,
) -> Option<Vec<(usize, usize)>> {
    // the last of the earlier runs of that length
    let recorded = along.recorded;
    let start_of = |block: usize| {
        let row = recorded.blocks[block].rows.start;
        let run = recorded.context.runs.iter().find(|run| run.contains(&row));
        run.map_or(0, |run| row - run.start)
    };
    let ranges = along.ranges();
    let is_same = |own: usize, twin: usize| {
        let (own, twin) = (along.posture_of(own), along.posture_of(twin));
        let off = own.iter().zip(&twin).zip(&ranges);
        off.clone()
            .all(|((a, b), range)| (a - b).abs() <= SAME_POSTURE * range.max(1e-12))
    };
    let mut pairs = Vec::with_capacity(after.len());
    let mut earlier = before.clone().rev().peekable();
    for own in after.clone().rev() {
        let place = start_of(own);
        while earlier.peek().is_some_and(|&twin| start_of(twin) > place) {
            earlier.next();
        }
        let Some(&twin) = earlier.peek().filter(|&&twin| start_of(twin) == place) else {
            continue;
        };
        if is_same(own, twin) {
            pairs.push((own, twin));
        }
    }
    pairs.reverse();
    (5 * pairs.len() >= 4 * after.len()).then_some(pairs)
}
