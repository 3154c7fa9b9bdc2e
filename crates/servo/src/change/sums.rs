//! Sums of products of a regression's rows, from which any stretch of a log is fitted without going through it.

use std::ops::Range;

use crate::log::{Series, mean};

/// Past readings of the position in the regression.
pub(super) const ORDER: usize = 2;
/// Past of the command that the regression sees \[s\].
const MEMORY_S: f64 = 0.32;
/// Grid points over a log at most.
const MOST_POINTS: usize = 1200;
/// Least rows between them.
const LEAST_STEP: usize = 10;

/// Position on its own past, the command's past, and a constant (an ARX model: Ljung, System Identification, 4.2), all less the
/// position's mean.
#[derive(Debug)]
pub(super) struct Regression {
    position: Vec<f64>,
    command: Vec<f64>,
    pieces: Vec<Range<usize>>,
    /// Piece of each row.
    piece: Vec<usize>,
    /// Lags of the command.
    pub(super) lags: usize,
    /// Rows between grid points.
    pub(super) step: usize,
    pub(super) rows: usize,
    /// Square of a reading's rounding: what no row is known better than.
    pub(super) rounding: f64,
}

/// A symmetric matrix of sums: regressors, then the target.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    pub(super) size: usize,
    pub(super) values: Vec<f64>,
}

/// Sums up to each grid point.
#[derive(Debug)]
pub(super) struct Prefix {
    points: Vec<Sums>,
    step: usize,
    shift: isize,
}

impl Regression {
    pub(super) fn new(series: &Series) -> Self {
        let middle = mean(&series.response);
        let rows = series.len();
        let pieces: Vec<Range<usize>> = series.pieces().collect();
        let mut piece = vec![0; rows];
        for (index, range) in pieces.iter().enumerate() {
            piece[range.clone()].fill(index);
        }
        Self {
            position: series.response.iter().map(|value| value - middle).collect(),
            command: series.command.iter().map(|value| value - middle).collect(),
            pieces,
            piece,
            lags: ((MEMORY_S / series.step_s).round() as usize).clamp(6, 16),
            step: (rows / MOST_POINTS).max(LEAST_STEP),
            rows,
            // two readings of each row, each rounded
            rounding: 2.0 * series.count * series.count / 12.0,
        }
    }

    /// Number of regressors, the constant last.
    pub(super) fn regressors(&self) -> usize {
        ORDER + self.lags + 1
    }

    /// Whether the command moved within the memory of a row, or the row has no past.
    fn has_past(&self, row: usize) -> bool {
        row >= self.pieces[self.piece[row]].start + self.lags
    }

    /// Adds a row with the command as it was `shift` rows before.
    fn add(&self, row: usize, shift: isize, sums: &mut Sums) {
        if !self.has_past(row) {
            return;
        }
        let own = &self.pieces[self.piece[row]];
        let mut values = [0.0; 24];
        let count = self.regressors();
        for (past, value) in values[..ORDER].iter_mut().enumerate() {
            *value = self.position[row - past - 1];
        }
        for lag in 0..self.lags {
            let at = (row - lag) as isize - shift;
            let at = at.clamp(own.start as isize, own.end as isize - 1) as usize;
            values[ORDER + lag] = self.command[at];
        }
        values[count - 1] = 1.0;
        values[count] = self.position[row];
        sums.add(&values[..=count]);
    }

    /// Sums up to each grid point.
    pub(super) fn prefix(&self, shift: isize) -> Prefix {
        let mut at = Sums::zeros(self.regressors() + 1);
        let mut points = vec![at.clone()];
        for row in 0..self.rows {
            self.add(row, shift, &mut at);
            if (row + 1) % self.step == 0 {
                points.push(at.clone());
            }
        }
        Prefix {
            points,
            step: self.step,
            shift,
        }
    }

    /// Sums of the rows before one.
    pub(super) fn up_to(&self, prefix: &Prefix, row: usize) -> Sums {
        let point = (row / prefix.step).min(prefix.points.len() - 1);
        let mut sums = prefix.points[point].clone();
        for row in point * prefix.step..row {
            self.add(row, prefix.shift, &mut sums);
        }
        sums
    }

    /// What the fit of some sums predicts of a row.
    pub(super) fn predicted(&self, solution: &[f64], row: usize) -> Option<f64> {
        if !self.has_past(row) {
            return None;
        }
        let own = &self.pieces[self.piece[row]];
        let mut value = solution.get(self.regressors() - 1).copied()?;
        for past in 0..ORDER {
            value += solution[past] * self.position[row - past - 1];
        }
        for lag in 0..self.lags {
            value += solution[ORDER + lag] * self.command[(row - lag).max(own.start)];
        }
        Some(value)
    }

    pub(super) fn position(&self, row: usize) -> f64 {
        self.position[row]
    }
}

impl Sums {
    pub(super) fn zeros(size: usize) -> Self {
        Self {
            size,
            values: vec![0.0; size * size],
        }
    }

    fn add(&mut self, row: &[f64]) {
        for (i, a) in row.iter().enumerate() {
            let own = &mut self.values[i * self.size..i * self.size + i + 1];
            for (sum, b) in own.iter_mut().zip(row) {
                *sum += a * b;
            }
        }
    }

    /// Lower triangle alone.
    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        self.values[i.max(j) * self.size + i.min(j)]
    }

    pub(super) fn plus(&self, other: &Self, sign: f64) -> Self {
        let pairs = self.values.iter().zip(&other.values);
        Self {
            size: self.size,
            values: pairs.map(|(a, b)| a + sign * b).collect(),
        }
    }

    /// Some columns times a factor.
    pub(super) fn scaled(&self, columns: Range<usize>, factor: f64) -> Self {
        let mut scaled = self.clone();
        for i in 0..self.size {
            for j in 0..=i {
                for column in [i, j] {
                    if columns.contains(&column) {
                        scaled.values[i * self.size + j] *= factor;
                    }
                }
            }
        }
        scaled
    }

    /// With a further regressor, 1 on the rows of `after` and 0 on the others, before the target.
    pub(super) fn with_step(&self, after: &Self) -> Self {
        let size = self.size + 1;
        let (constant, target) = (self.size - 2, self.size - 1);
        let mut with = Self::zeros(size);
        let from = |index: usize| if index == size - 1 { target } else { index };
        for i in 0..size {
            for j in 0..=i {
                let value = match (i == size - 2, j == size - 2) {
                    (true, true) => after.at(constant, constant),
                    (true, false) => after.at(constant, from(j)),
                    (false, true) => after.at(constant, from(i)),
                    (false, false) => self.at(from(i), from(j)),
                };
                with.values[i * size + j] = value;
            }
        }
        with
    }

    /// Squares that the best fit leaves, and its coefficients, by Cholesky's factor of the scaled normal equations; the weakest
    /// directions are held by a ridge.
    pub(super) fn fitted(&self) -> (f64, Vec<f64>) {
        let count = self.size - 1;
        let scale: Vec<f64> = (0..count)
            .map(|i| self.at(i, i).max(1e-300).sqrt())
            .collect();
        let mut factor = vec![0.0; count * count];
        let mut right = vec![0.0; count];
        let mut rest = self.at(count, count);
        for i in 0..count {
            for j in 0..=i {
                let mut sum = self.at(i, j) / (scale[i] * scale[j]);
                if i == j {
                    sum += 1e-9;
                }
                for k in 0..j {
                    sum -= factor[i * count + k] * factor[j * count + k];
                }
                factor[i * count + j] = if i == j {
                    sum.max(1e-12).sqrt()
                } else {
                    sum / factor[j * count + j]
                };
            }
            let mut sum = self.at(count, i) / scale[i];
            for k in 0..i {
                sum -= factor[i * count + k] * right[k];
            }
            right[i] = sum / factor[i * count + i];
            rest -= right[i] * right[i];
        }
        let mut solution = vec![0.0; count];
        for i in (0..count).rev() {
            let mut sum = right[i];
            for k in i + 1..count {
                sum -= factor[k * count + i] * solution[k];
            }
            solution[i] = sum / factor[i * count + i];
        }
        for (value, scale) in solution.iter_mut().zip(&scale) {
            *value /= scale;
        }
        (rest.max(0.0), solution)
    }
}
