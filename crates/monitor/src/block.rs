//! Rows reduced to sums: what a block of successive rows needs to keep.

/// Rows of the shortest block. The mean of fewer is not normal enough where single readings are wild.
pub(crate) const BASE_ROWS: usize = 8;
/// Most blocks that a reference keeps; beyond it neighbours are merged, and blocks are twice as long.
pub(crate) const MOST_BLOCKS: usize = 4096;

/// Readings of one component in a block, in units of its scale.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sums {
    pub(crate) count: u32,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

impl Sums {
    pub(crate) fn add(&mut self, value: f64) {
        self.count += 1;
        self.sum += value;
        self.squares += value * value;
    }

    pub(crate) fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    /// The features of a block: its mean, and the cube root of its mean square, which is nearly normal where the readings are
    /// (Wilson & Hilferty 1931). None where there are fewer than half as many readings as blocks of the reference have.
    pub(crate) fn features(self, usual: f64) -> Option<[f64; 2]> {
        if self.count == 0 || 2.0 * f64::from(self.count) < usual {
            return None;
        }
        let count = f64::from(self.count);
        Some([self.sum / count, (self.squares / count).cbrt()])
    }
}

/// Blocks of a reference, bounded: neighbours are merged where they are too many.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    components: usize,
    /// Rows of a block.
    pub(crate) rows: usize,
    /// Block after block, component after component.
    done: Vec<Sums>,
    open: Vec<Sums>,
    open_rows: usize,
}

impl Blocks {
    pub(crate) fn new(components: usize) -> Self {
        Self {
            components,
            rows: BASE_ROWS,
            done: Vec::with_capacity(components * MOST_BLOCKS),
            open: vec![Sums::default(); components],
            open_rows: 0,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.done.len() / self.components.max(1)
    }

    /// Takes a row in units of the scales; says whether a block was closed.
    pub(crate) fn push(&mut self, row: &[f64]) -> bool {
        for (sums, value) in self.open.iter_mut().zip(row) {
            if value.is_finite() {
                sums.add(*value);
            }
        }
        self.open_rows += 1;
        if self.open_rows < self.rows {
            return false;
        }
        self.open_rows = 0;
        self.done.extend(self.open.iter().copied());
        self.open.fill(Sums::default());
        if self.len() == MOST_BLOCKS {
            self.merge_neighbours();
        }
        true
    }

    fn merge_neighbours(&mut self) {
        let n = self.components;
        for block in 0..self.len() / 2 {
            for component in 0..n {
                let mut sums = self.done[2 * block * n + component];
                sums.merge(self.done[(2 * block + 1) * n + component]);
                self.done[block * n + component] = sums;
            }
        }
        self.done.truncate(self.len() / 2 * n);
        self.rows *= 2;
    }

    /// The sums of one component in blocks of `factor` blocks; a rest is left out.
    pub(crate) fn merged(
        &self,
        component: usize,
        factor: usize,
    ) -> impl Iterator<Item = Sums> + '_ {
        (0..self.len() / factor).map(move |block| {
            let mut sums = Sums::default();
            for part in 0..factor {
                sums.merge(self.done[(block * factor + part) * self.components + component]);
            }
            sums
        })
    }
}
