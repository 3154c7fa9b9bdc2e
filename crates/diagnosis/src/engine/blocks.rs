//! Averages successive rows into blocks of white unit noise: a linear map of residuals, derivatives
//! and effects alike, which keeps what varies slowly and costs a fraction of the arithmetic.

use std::borrow::Cow;

use haptical_calibration::Channel;
use haptical_effects::Context;

use crate::engine::layout::Layout;
use crate::noise::Noise;
use crate::thresholds::fit::{BLOCKS, LONGEST_REST_ROWS};
use crate::thresholds::lines::SHARE_OF_A_PERIOD;

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
    /// Row in the middle.
    row: usize,
}

/// Blocks of one stream.
#[derive(Debug, Clone)]
struct StreamBlocks {
    rows: Vec<usize>,
    entries: Vec<Entry>,
    colour: f64,
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
    /// Rows in a block of a stream without spectral lines.
    pub(crate) size: usize,
}

impl Blocks {
    /// Cuts every stream's usable rows into blocks. `own` is the sensor's stated standard deviation per
    /// stream, `scale` what the speed makes of it at each row.
    pub(crate) fn new(
        context: &Context<'_>,
        usable: &[Vec<bool>],
        scale: &[Option<Vec<f64>>],
        own: &[f64],
        noise: &[Noise],
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
                colour: block_colour(&noise[stream], size).1,
                size,
                first: count,
            };
            let inflation = block_colour(&noise[stream], size).0;
            let mut previous_end = usize::MAX;
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
                let variance = factor * (sensor / number * inflation / number + rounding);
                let starts_run = context.runs.iter().any(|run| run.start == *start);
                blocks.entries.push(Entry {
                    first,
                    end: last,
                    scale: 1.0 / variance.sqrt().max(1e-300),
                    follows: !starts_run && previous_end == *start,
                    row: members[members.len() / 2],
                });
                previous_end = *end;
            }
            count += blocks.entries.len();
            streams.push(blocks);
        }
        Self {
            streams,
            count,
            size,
        }
    }

    /// Whitened blocks of all streams.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Where a stream's blocks are among all.
    pub(crate) fn range(&self, stream: usize) -> std::ops::Range<usize> {
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

    /// Whether a stream's block is the first of an uninterrupted series.
    pub(crate) fn begins(&self, stream: usize, block: usize) -> bool {
        !self.streams[stream].entries[block].follows
    }

    /// Means over blocks, over their standard deviations, whitened.
    pub(crate) fn compress(&self, stream: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let blocks = &self.streams[stream];
        let mut out = Vec::with_capacity(blocks.entries.len());
        let whitening = 1.0 / (1.0 - blocks.colour * blocks.colour).sqrt();
        let mut before = 0.0;
        for entry in &blocks.entries {
            let rows = &blocks.rows[entry.first..entry.end];
            let mean = rows.iter().map(|&row| value(row)).sum::<f64>() / rows.len() as f64;
            let scaled = mean * entry.scale;
            if entry.follows && blocks.colour != 0.0 {
                out.push((scaled - blocks.colour * before) * whitening);
            } else {
                out.push(scaled);
            }
            before = scaled;
        }
        out
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
    const SURVIVING: f64 = 1e-9;

    fn count(&self) -> usize {
        self.count()
    }

    fn range(&self, stream: usize) -> std::ops::Range<usize> {
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

/// Variance of a mean of `size` rows over that of white rows, and the correlation of successive means.
fn block_colour(noise: &Noise, size: usize) -> (f64, f64) {
    let (colour, share) = (noise.colour, noise.coloured_share);
    if colour == 0.0 || share == 0.0 {
        return (1.0, 0.0);
    }
    let number = size as f64;
    let inside: f64 = (1..size)
        .map(|lag| 2.0 * (1.0 - lag as f64 / number) * colour.powi(lag as i32))
        .sum();
    let inflation = 1.0 + share * inside;
    let between =
        share * colour * (1.0 - colour.powi(size as i32)).powi(2) / (1.0 - colour).powi(2) / number;
    (inflation, (between / inflation).clamp(-0.95, 0.95))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_of_blocks_agrees_with_the_sums() {
        let (colour, size) = (0.5_f64, 4_usize);
        let covariance = |a: usize, b: usize| colour.powi((a as i32 - b as i32).abs());
        let mut own = 0.0;
        let mut next = 0.0;
        for a in 0..size {
            for b in 0..size {
                own += covariance(a, b) / size as f64;
                next += covariance(a, b + size) / size as f64;
            }
        }
        let noise = Noise {
            ratio: 1.0,
            colour,
            coloured_share: 1.0,
            uncertainty: 0.0,
            freedom: 100.0,
            source: crate::noise::NoiseSource::Motion,
            speed_ratio: 1.0,
        };
        let (inflation, correlation) = block_colour(&noise, size);
        assert!((inflation - own).abs() < 1e-12);
        assert!((correlation - next / own).abs() < 1e-12);
        assert_eq!(block_colour(&noise, 1), (1.0, 0.5));
    }
}
