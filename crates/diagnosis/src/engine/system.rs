//! Whitened residuals with everything that the base model can adjust projected out.

use std::ops::Range;

use haptical_effects::{Context, Signal};
use haptical_linalg::Direction;
pub(crate) use haptical_linalg::{dot, take_off};

use crate::engine::{Blocks, Layout};
use crate::thresholds::engine::ABSENT_DIRECTION;
use crate::thresholds::fit::WINDOW_S;

/// Two passes of a projection whatever is left.
pub(crate) const ALWAYS: f64 = f64::INFINITY;

/// A signal averaged and whitened, stream by stream.
#[derive(Debug, Clone, Default)]
pub(crate) struct Column {
    pub(crate) parts: Vec<(usize, Vec<f64>)>,
}

/// Residuals and directions that are no longer news.
#[derive(Debug, Clone)]
pub(crate) struct System<L = Blocks> {
    pub(crate) layout: L,
    /// Orthonormal; the base model's first, then those of the causes found.
    pub(crate) basis: Vec<Direction>,
    /// Across the basis.
    pub(crate) residual: Vec<f64>,
    /// Windows per stream, as ranges of all blocks.
    windows: Vec<Vec<Range<usize>>>,
    /// Oscillations of the stream's lines, run by run, of length 1.
    pub(crate) oscillations: Vec<Vec<Oscillation>>,
}

/// Whitened values at a range of all blocks.
pub(crate) type Oscillation = (Range<usize>, Vec<f64>);

impl System {
    /// Takes physical residuals per stream and row, and projects them.
    pub(crate) fn set_residual(&mut self, residual: &[Vec<f64>]) {
        self.project_reading(self.layout.compress_rows(residual));
    }

    pub(crate) fn column(&self, signal: &Signal) -> Column {
        let parts = signal
            .parts
            .iter()
            .map(|(stream, values)| (*stream, self.layout.compress(*stream, |row| values[row])))
            .collect();
        Column { parts }
    }

    /// Removes a signal from the residual and from everything later.
    pub(crate) fn project_out(&mut self, signal: &Signal) {
        self.take(self.layout.dense(signal));
    }

    /// The same with nothing of the other streams in it.
    pub(crate) fn of_stream(&self, stream: usize) -> Self {
        let range = self.layout.range(stream);
        let masked = |vector: &Vec<f64>| {
            let mut own = vector.clone();
            mask(&mut own, range.clone());
            own
        };
        let residual = masked(&self.residual);
        let mut system = Self::bare(self.layout.clone(), self.windows.clone(), residual);
        system.oscillations.clone_from(&self.oscillations);
        for direction in &self.basis {
            let entries = 0..self.residual.len();
            system.take(masked(
                &entries.map(|entry| direction.entry(entry)).collect(),
            ));
        }
        system
    }

    /// The row in the middle of every block.
    pub(crate) fn postures(&self) -> Vec<usize> {
        (0..self.windows.len())
            .flat_map(|stream| {
                let blocks = 0..self.layout.range(stream).len();
                blocks.map(move |block| self.layout.row(stream, block))
            })
            .collect()
    }
}

impl<L: Layout> System<L> {
    /// Whitened readings without a model, with the windows of each stream.
    pub(crate) fn bare(layout: L, windows: Vec<Vec<Range<usize>>>, reading: Vec<f64>) -> Self {
        Self {
            layout,
            basis: Vec::new(),
            residual: reading,
            oscillations: vec![Vec::new(); windows.len()],
            windows,
        }
    }

    /// Takes whitened readings, and projects them.
    pub(crate) fn project_reading(&mut self, mut whitened: Vec<f64>) {
        take_off_all(&mut whitened, || self.basis.iter());
        self.residual = whitened;
    }

    /// Product of a column with a vector over all blocks.
    pub(crate) fn dot(&self, column: &Column, vector: &[f64]) -> f64 {
        column
            .parts
            .iter()
            .map(|(stream, values)| dot(values, &vector[self.layout.range(*stream)]))
            .sum()
    }

    /// The same with a direction.
    pub(crate) fn dot_direction(&self, column: &Column, direction: &Direction) -> f64 {
        let parts = column.parts.iter();
        let along = |(stream, values): &(usize, Vec<f64>)| {
            direction.dot_part(values, self.layout.range(*stream).start)
        };
        parts.map(along).sum()
    }

    /// A column over all blocks.
    pub(crate) fn dense(&self, column: &Column) -> Vec<f64> {
        let mut dense = vec![0.0; self.layout.count()];
        for (stream, values) in &column.parts {
            dense[self.layout.range(*stream)].copy_from_slice(values);
        }
        dense
    }

    /// Removes a column over all blocks from the residual and from everything later.
    pub(crate) fn take(&mut self, dense: Vec<f64>) {
        self.take_again_below(ALWAYS, dense);
    }

    /// The same with one pass where more than a share of the column's length is left: the column's products with the
    /// basis, its own direction last; none where the basis has it already.
    pub(crate) fn take_again_below(&mut self, share: f64, dense: Vec<f64>) -> Option<Vec<f64>> {
        let across = across(dense, share, || self.basis.iter())?;
        take_off(&mut self.residual, &across.direction);
        self.basis.push(Direction::new(across.direction));
        Some(across.products)
    }

    pub(crate) fn windows(&self, stream: usize) -> usize {
        self.windows[stream].len()
    }

    /// Slow energy of a residual per stream, with the degrees of freedom that it has under noise:
    /// sums over windows of a quarter of a second, over the root of their number of blocks; and that of its
    /// spectral lines.
    pub(crate) fn slow_energy(&self, residual: &[f64]) -> Vec<SlowEnergy> {
        let streams = self.windows.iter().zip(&self.oscillations);
        streams
            .map(|(windows, oscillations)| {
                // of a vector that is zero before `first`, and behind what is given
                let energy = |first: usize, vector: &[f64]| {
                    let within = |blocks: &Range<usize>| {
                        let place = |block: usize| block.saturating_sub(first).min(vector.len());
                        place(blocks.start)..place(blocks.end)
                    };
                    let sum = |window: &Range<usize>| {
                        vector[within(window)].iter().sum::<f64>() / (window.len() as f64).sqrt()
                    };
                    let slow: f64 = windows.iter().map(|w| sum(w).powi(2)).sum();
                    let along = |(blocks, values): &Oscillation| {
                        let own = within(blocks);
                        let skipped = (own.start + first).saturating_sub(blocks.start);
                        dot(&values[skipped.min(values.len())..], &vector[own])
                    };
                    slow + oscillations.iter().map(|o| along(o).powi(2)).sum::<f64>()
                };
                let taken = self
                    .basis
                    .iter()
                    .map(|own| energy(own.first(), own.values()));
                let taken: f64 = taken.sum();
                let count = windows.len() + oscillations.len();
                SlowEnergy {
                    energy: energy(0, residual),
                    freedom: (count as f64 - taken).max(0.0),
                }
            })
            .collect()
    }
}

/// The part of a vector across orthonormal directions.
pub(crate) struct Across {
    /// Of length 1.
    pub(crate) direction: Vec<f64>,
    /// Products of the vector with the orthonormal directions and with its own.
    pub(crate) products: Vec<f64>,
}

/// The part of a vector across orthonormal directions; none where nothing is left. A second pass takes off what rounding
/// left in the first, where less than `again_below` of the length is left (Daniel, Gragg, Kaufman & Stewart 1976).
pub(crate) fn across<'d, D: Iterator<Item = &'d Direction>>(
    mut vector: Vec<f64>,
    again_below: f64,
    directions: impl Fn() -> D,
) -> Option<Across> {
    let length = dot(&vector, &vector).sqrt();
    let mut products: Vec<f64> = directions().map(|d| d.take_off(&mut vector)).collect();
    let mut left = dot(&vector, &vector).sqrt();
    if left <= again_below * length {
        for (product, direction) in products.iter_mut().zip(directions()) {
            *product += direction.take_off(&mut vector);
        }
        left = dot(&vector, &vector).sqrt();
    }
    if left <= ABSENT_DIRECTION * length || left == 0.0 {
        return None;
    }
    vector.iter_mut().for_each(|entry| *entry /= left);
    products.push(left);
    Some(Across {
        direction: vector,
        products,
    })
}

/// Takes the parts along orthonormal directions off a vector, twice: one pass leaves the rounding of large coefficients.
pub(crate) fn take_off_all<'d, D: Iterator<Item = &'d Direction>>(
    vector: &mut [f64],
    directions: impl Fn() -> D,
) {
    for direction in directions().chain(directions()) {
        direction.take_off(vector);
    }
}

/// Sets everything but a range to zero.
pub(crate) fn mask(vector: &mut [f64], range: Range<usize>) {
    vector[..range.start].fill(0.0);
    vector[range.end..].fill(0.0);
}

/// Slow energy of one stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlowEnergy {
    pub(crate) energy: f64,
    pub(crate) freedom: f64,
}

impl SlowEnergy {
    /// What noise does not account for.
    pub(crate) fn excess(self) -> f64 {
        self.energy - self.freedom
    }
}

/// Cosine and sine of every line of every stream, each run's alone.
pub(crate) fn oscillations(context: &Context<'_>, blocks: &Blocks) -> Vec<Vec<Oscillation>> {
    let of_stream = |stream: usize| {
        let channel = context.streams[stream].channel;
        let range = blocks.range(stream);
        let mut found = Vec::new();
        for hz in context.lines_of(channel) {
            for wave in context.oscillation(channel, hz) {
                let column = blocks.compress(stream, |row| wave[row]);
                for run in &context.runs {
                    let first =
                        (0..range.len()).position(|block| run.contains(&blocks.row(stream, block)));
                    let Some(first) = first else { continue };
                    let own = (first..range.len())
                        .take_while(|block| run.contains(&blocks.row(stream, *block)))
                        .count();
                    let mut values = column[first..first + own].to_vec();
                    let length = dot(&values, &values).sqrt();
                    if length > 0.0 {
                        values.iter_mut().for_each(|value| *value /= length);
                        let start = range.start + first;
                        found.push((start..start + own, values));
                    }
                }
            }
        }
        found
    };
    (0..context.streams.len()).map(of_stream).collect()
}

pub(crate) fn windows(context: &Context<'_>, blocks: &Blocks) -> Vec<Vec<Range<usize>>> {
    (0..context.streams.len())
        .map(|stream| {
            let length = window_blocks(context, blocks.size_of(stream));
            let range = blocks.range(stream);
            let mut windows = Vec::new();
            let mut start = range.start;
            for block in range.clone() {
                let next = block + 1;
                let ends = next == range.end
                    || next - start == length
                    || blocks.begins(stream, next - range.start);
                if ends {
                    windows.push(start..next);
                    start = next;
                }
            }
            windows
        })
        .collect()
}

fn window_blocks(context: &Context<'_>, size: usize) -> usize {
    if !context.ordered {
        return 1;
    }
    if context.recording.time_s.is_none() {
        return 4;
    }
    let block_s = context.moving_s() / context.rows().max(1) as f64 * size as f64;
    if block_s > 0.0 {
        ((WINDOW_S / block_s).round() as usize).clamp(2, 64)
    } else {
        4
    }
}
