//! Rows of blocks at which a search works out the base model.

use crate::engine::Blocks;

/// Some rows of each block, each with its share of the block's rows: what a base model changes by on the way of a search is straight
/// between them.
#[derive(Debug)]
pub(super) struct Samples {
    /// Rows of the recording that are samples of any stream, ascending; none where all rows are.
    pub(super) rows: Option<Vec<usize>>,
    streams: Vec<StreamSamples>,
}

/// Samples of the blocks of one stream, block by block.
#[derive(Debug)]
struct StreamSamples {
    /// Row and share.
    samples: Vec<(usize, f64)>,
    /// Where the samples of each block end.
    ends: Vec<usize>,
}

impl Samples {
    /// One sample for at most so many rows.
    pub(super) fn new(blocks: &Blocks, streams: usize, rows: usize, every: usize) -> Self {
        let of_stream = |stream: usize| {
            let (mut samples, mut ends) = (Vec::new(), Vec::new());
            for rows in blocks.rows_of(stream) {
                let pieces = rows.len().div_ceil(every);
                let bound = |piece: usize| piece * rows.len() / pieces;
                for piece in (0..pieces).map(|piece| &rows[bound(piece)..bound(piece + 1)]) {
                    let share = piece.len() as f64 / rows.len() as f64;
                    samples.push((piece[piece.len() / 2], share));
                }
                ends.push(samples.len());
            }
            StreamSamples { samples, ends }
        };
        let mut streams: Vec<StreamSamples> = (0..streams).map(of_stream).collect();
        let mut is_sample = vec![false; rows];
        for (row, _) in streams.iter().flat_map(|stream| &stream.samples) {
            is_sample[*row] = true;
        }
        let chosen: Vec<usize> = (0..rows).filter(|&row| is_sample[row]).collect();
        if 2 * chosen.len() > rows {
            return Self {
                rows: None,
                streams: Vec::new(),
            };
        }
        let mut place = vec![0; rows];
        for (index, &row) in chosen.iter().enumerate() {
            place[row] = index;
        }
        for (row, _) in streams.iter_mut().flat_map(|stream| &mut stream.samples) {
            *row = place[*row];
        }
        Self {
            rows: Some(chosen),
            streams,
        }
    }

    /// Whitened blocks of a stream by its values at samples.
    pub(super) fn compress(
        &self,
        blocks: &Blocks,
        stream: usize,
        value: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        if self.rows.is_none() {
            return blocks.compress(stream, value);
        }
        let StreamSamples { samples, ends } = &self.streams[stream];
        let mut first = 0;
        let means = ends.iter().map(|&end| {
            let of_block = &samples[first..end];
            first = end;
            of_block
                .iter()
                .map(|&(row, share)| share * value(row))
                .sum()
        });
        blocks.whitened(stream, means)
    }
}
