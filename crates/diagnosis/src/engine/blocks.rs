//! Averages successive rows into blocks of white unit noise: a linear map of residuals, derivatives
//! and effects alike, which keeps what varies slowly and costs a fraction of the arithmetic.

use std::borrow::Cow;
use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::{Context, Signal};

use crate::noise::rounding::Counts;
use crate::noise::{KnownNoise, Noise};
use crate::thresholds::engine::SURVIVING;
use crate::thresholds::fit::{BLOCKS, LONGEST_REST_ROWS};
use crate::thresholds::lines::SHARE_OF_A_PERIOD;
use crate::thresholds::noise::{MOST_OF_BLOCKS, ONE_READING};

/// One block of one stream.
#[derive(Debug, Clone)]
struct Entry {
    /// Usable rows, as a range of the stream's list.
    first: usize,
    end: usize,
    /// One over the standard deviation of the mean.
    scale: f64,
    /// The entry before it is the block before it in the same run.
    follows: bool,
    /// Correlation of its mean with that of the entry before it; 0 where a series begins.
    colour: f64,
    /// Row in the middle.
    row: usize,
}

/// Blocks of one stream.
#[derive(Debug, Clone)]
struct StreamBlocks {
    rows: Vec<usize>,
    entries: Vec<Entry>,
    /// Rows in a block.
    size: usize,
    /// Where its entries begin among all streams'.
    first: usize,
}

/// The blocks of every stream.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    streams: Vec<StreamBlocks>,
    count: usize,
}

impl Blocks {
    /// Cuts every stream's usable rows into blocks. `own` is the sensor's stated standard deviation per stream.
    pub(crate) fn new(
        context: &Context<'_>,
        usable: &[Vec<bool>],
        own: &[f64],
        KnownNoise { noise, scale }: &KnownNoise,
    ) -> Self {
        let size = if context.ordered {
            context.rows().div_ceil(BLOCKS).max(1)
        } else {
            1
        };
        let whole = ranges(context, size);
        let mut streams = Vec::new();
        let mut count = 0;
        for stream in 0..context.streams.len() {
            let channel = context.streams[stream].channel;
            let (size, ranges) = match longest_of_lines(context, channel) {
                Some(longest) if longest < size => (longest, Cow::Owned(ranges(context, longest))),
                _ => (size, Cow::Borrowed(&whole)),
            };
            let mut blocks = StreamBlocks {
                rows: Vec::new(),
                entries: Vec::new(),
                size,
                first: count,
            };
            let counts = Counts::new(context, &context.streams[stream]).filter(|_| context.ordered);
            let mut previous_end = usize::MAX;
            let mut before = 0..0;
            let mut variances = [0.0; 2];
            for (start, end) in ranges.iter() {
                let first = blocks.rows.len();
                let rows = (*start..*end).filter(|&row| usable[stream][row]);
                blocks.rows.extend(rows);
                let last = blocks.rows.len();
                if last == first {
                    continue;
                }
                let members = &blocks.rows[first..last];
                let factor = noise[stream].ratio * noise[stream].ratio;
                let number = members.len() as f64;
                let sensor: f64 = members
                    .iter()
                    .map(|&row| {
                        let by_speed = scale[stream].as_ref().map_or(1.0, |scale| scale[row]);
                        (own[stream] * by_speed).powi(2)
                    })
                    .sum();
                let rounding = rounding_variance(context, stream, *start, *end);
                let inflation = inflation(&noise[stream], members);
                // variance beyond that of the counts is noise of single rows
                let rounded = counts.as_ref().map_or(0.0, Counts::variance);
                let of_rows = (factor * sensor - number * rounded).max(0.0);
                let of_rows = of_rows / number * inflation / number;
                let different = counts
                    .as_ref()
                    .map_or(1.0, |counts| counts.different(members));
                let of_counts = rounded / different;
                let variance = of_rows + of_counts + factor * rounding;
                let starts_run = context.runs.iter().any(|run| run.start == *start);
                let follows = !starts_run && previous_end == *start;
                let colour = match follows {
                    true => {
                        let before = &blocks.rows[before];
                        let of_rows_alone = correlation(&noise[stream], before, members);
                        match &counts {
                            None => of_rows_alone,
                            Some(counts) => {
                                let common = of_rows_alone * (variances[0] * of_rows).sqrt()
                                    + counts.common(before, members);
                                let sizes = (variances[1] * variance).sqrt();
                                (common / sizes.max(1e-300)).clamp(-MOST_OF_BLOCKS, ONE_READING)
                            }
                        }
                    }
                    false => 0.0,
                };
                variances = [of_rows, variance];
                blocks.entries.push(Entry {
                    first,
                    end: last,
                    scale: 1.0 / variance.sqrt().max(1e-300),
                    follows,
                    colour,
                    row: members[members.len() / 2],
                });
                before = first..last;
                previous_end = *end;
            }
            count += blocks.entries.len();
            streams.push(blocks);
        }
        Self { streams, count }
    }

    /// Whitened blocks of all streams.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Where a stream's blocks are among all.
    pub(crate) fn range(&self, stream: usize) -> Range<usize> {
        let blocks = &self.streams[stream];
        blocks.first..blocks.first + blocks.entries.len()
    }

    /// Rows in a block of a stream.
    pub(crate) fn size_of(&self, stream: usize) -> usize {
        self.streams[stream].size
    }

    /// Middle row of a stream's block.
    pub(crate) fn row(&self, stream: usize, block: usize) -> usize {
        self.streams[stream].entries[block].row
    }

    /// First row of a stream's block.
    pub(crate) fn first_row(&self, stream: usize, block: usize) -> usize {
        let blocks = &self.streams[stream];
        blocks.rows[blocks.entries[block].first]
    }

    /// Whether a stream's block is the first of an uninterrupted series.
    pub(crate) fn begins(&self, stream: usize, block: usize) -> bool {
        !self.streams[stream].entries[block].follows
    }

    /// Means over blocks, over their standard deviations, whitened.
    pub(crate) fn compress(&self, stream: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let mean =
            |rows: &[usize]| rows.iter().map(|&row| value(row)).sum::<f64>() / rows.len() as f64;
        let blocks = &self.streams[stream];
        let of_entry = |entry: &Entry| mean(&blocks.rows[entry.first..entry.end]);
        self.whitened(stream, blocks.entries.iter().map(of_entry))
    }

    /// Rows of each block of a stream.
    pub(super) fn rows_of(&self, stream: usize) -> impl Iterator<Item = &[usize]> {
        let StreamBlocks { rows, entries, .. } = &self.streams[stream];
        entries.iter().map(|entry| &rows[entry.first..entry.end])
    }

    /// A stream's means by block, over their standard deviations, whitened.
    pub(super) fn whitened(&self, stream: usize, means: impl Iterator<Item = f64>) -> Vec<f64> {
        let blocks = &self.streams[stream];
        let mut out = Vec::with_capacity(blocks.entries.len());
        let mut before = 0.0;
        for (entry, mean) in blocks.entries.iter().zip(means) {
            let scaled = mean * entry.scale;
            let fresh = (1.0 - entry.colour * entry.colour).sqrt();
            out.push((scaled - entry.colour * before) / fresh);
            before = scaled;
        }
        out
    }
}

impl Blocks {
    /// A signal on all blocks; what no channel shows is left out.
    pub(crate) fn dense(&self, signal: &Signal) -> Vec<f64> {
        let mut dense = vec![0.0; self.count()];
        for (stream, values) in &signal.parts {
            let compressed = self.compress(*stream, |row| values[row]);
            dense[self.range(*stream)].copy_from_slice(&compressed);
        }
        dense
    }

    /// Values of all streams' rows on all blocks.
    pub(crate) fn compress_rows(&self, rows: &[Vec<f64>]) -> Vec<f64> {
        let streams = rows.iter().enumerate();
        let of_stream =
            |(stream, values): (usize, &Vec<f64>)| self.compress(stream, |row| values[row]);
        streams.flat_map(of_stream).collect()
    }
}

/// Rows of a block within which a channel's fastest line turns by at most a share of its period; none without one.
fn longest_of_lines(context: &Context<'_>, channel: Channel) -> Option<usize> {
    let lines = context.lines_of(channel);
    let fastest_hz = lines.into_iter().reduce(f64::max)?;
    let rows = context.rows().max(1) as f64;
    let row_s = context.moving_s() / rows;
    Some(((SHARE_OF_A_PERIOD / (fastest_hz * row_s)) as usize).max(1))
}

impl Layout for Blocks {
    const SURVIVING: f64 = SURVIVING;

    fn count(&self) -> usize {
        self.count()
    }

    fn range(&self, stream: usize) -> Range<usize> {
        self.range(stream)
    }
}

/// Blocks of rows: `size` rows each, or a whole rest.
fn ranges(context: &Context<'_>, size: usize) -> Vec<(usize, usize)> {
    let mut ranges = Vec::new();
    for run in &context.runs {
        let mut start = run.start;
        while start < run.end {
            let mut end = start + 1;
            if context.ordered {
                let still = |row: usize| {
                    let columns = &context.recording.joint;
                    columns.iter().all(|column| column[row] == column[row - 1])
                };
                while end < run.end && end - start < LONGEST_REST_ROWS && still(end) {
                    end += 1;
                }
            }
            if end - start < 2 * size {
                end = (start + size).min(run.end);
            }
            ranges.push((start, end));
            start = end;
        }
    }
    ranges
}

/// Variance that the rounding of readings puts into the mean of a block: joint by joint its variance
/// over the number of different readings, since readings that do not change share one error.
fn rounding_variance(context: &Context<'_>, stream: usize, start: usize, end: usize) -> f64 {
    let middle = (start + end) / 2;
    let mut variance = 0.0;
    for (joint, column) in context.recording.joint.iter().enumerate() {
        let Some(step) = context.device.joints[joint].reading_quantum_rad() else {
            continue;
        };
        let slope = match context.streams[stream].channel {
            Channel::Output { joint: own } if own == joint => 1.0,
            Channel::Output { .. } => continue,
            _ => context.sensitivity(stream, joint, middle),
        };
        let changes = (start + 1..end)
            .filter(|&row| column[row] != column[row - 1])
            .count();
        variance += (slope * step).powi(2) / 12.0 / (1 + changes) as f64;
    }
    variance
}

/// Variance of a mean of rows, some of which may be missing between them, over that of white rows: 1 + 2/n times the sum
/// of c^(j - i) over all pairs i < j.
fn inflation(noise: &Noise, rows: &[usize]) -> f64 {
    let (mut pairs, mut with_all_before) = (0.0, 0.0);
    for pair in rows.windows(2) {
        with_all_before = (with_all_before + 1.0) * power(noise.colour, pair[1] - pair[0]);
        pairs += with_all_before;
    }
    1.0 + noise.coloured_share * 2.0 * pairs / rows.len() as f64
}

/// Correlation of the means of rows and of others that follow them.
fn correlation(noise: &Noise, before: &[usize], rows: &[usize]) -> f64 {
    let Some(&last) = before.last() else {
        return 0.0;
    };
    let reach = |row: &usize| power(noise.colour, row.abs_diff(last));
    let sum = |rows: &[usize]| rows.iter().map(reach).sum::<f64>();
    let size = |rows: &[usize]| (rows.len() as f64 * inflation(noise, rows)).sqrt();
    let common = noise.coloured_share * sum(before) * sum(rows);
    (common / (size(before) * size(rows))).clamp(-MOST_OF_BLOCKS, MOST_OF_BLOCKS)
}

fn power(colour: f64, rows: usize) -> f64 {
    colour.powi(rows as i32)
}

/// Where the entries of streams are in a vector over all of them.
pub(crate) trait Layout {
    /// Squared share of a direction that must survive a projection to count.
    const SURVIVING: f64;

    /// Entries of all streams.
    fn count(&self) -> usize;

    /// Entries of a stream.
    fn range(&self, stream: usize) -> Range<usize>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_of_blocks_agrees_with_the_sums() {
        let colour = 0.5_f64;
        let covariance = |a: usize, b: usize| colour.powi((a as i32 - b as i32).abs());
        let noise = Noise {
            ratio: 1.0,
            colour,
            coloured_share: 1.0,
            uncertainty: 0.0,
            freedom: 100.0,
            source: crate::noise::NoiseSource::Motion,
            speed_ratio: 1.0,
        };
        let between = |a: &[usize], b: &[usize]| {
            let count = (a.len() * b.len()) as f64;
            let pairs = a.iter().flat_map(|a| b.iter().map(|b| covariance(*a, *b)));
            pairs.sum::<f64>() / count
        };
        // a rest of many rows beside blocks of few, and blocks with rows missing
        let kinds: [(Vec<usize>, Vec<usize>); 4] = [
            ((0..4).collect(), (4..8).collect()),
            ((0..60).collect(), (60..64).collect()),
            ((0..4).collect(), (4..64).collect()),
            (vec![0, 3], vec![5, 6, 9]),
        ];
        for (before, rows) in kinds {
            let own = between(&rows, &rows);
            assert!((inflation(&noise, &rows) - own * rows.len() as f64).abs() < 1e-12);
            let both = between(&before, &rows) / (own * between(&before, &before)).sqrt();
            assert!((correlation(&noise, &before, &rows) - both).abs() < 1e-12);
        }
        assert!((inflation(&noise, &[7]) - 1.0).abs() < 1e-15);
    }
}
