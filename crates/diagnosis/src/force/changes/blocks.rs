//! Two groups of runs side by side: their blocks, and which of them repeat one another.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::force::Means;
use crate::force::along::Along;
use crate::thresholds::payload::SAME_POSTURE;

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
