//! Sums of products of a regression's rows, from which any stretch of a log is fitted without going through it.

use std::ops::Range;

use crate::log::{Series, mean};

/// Past readings of the position in the regression.
pub(super) const ORDER: usize = 2;
/// Past of the command that the regression sees \[s\].
const MEMORY_S: f64 = 0.32;
/// Regressors at most, and the target.
const MOST_COLUMNS: usize = ORDER + MOST_LAGS + 5 + 2;
/// Lags of the command at most.
const MOST_LAGS: usize = 16;
/// Grid points over a log at most.
const MOST_POINTS: usize = 1200;
/// Least rows between them.
const LEAST_STEP: usize = 10;

/// Rows before and after a reading whose velocities it follows: velocities are a mean over the last rows, or of the next.
const VELOCITY_LAGS: Range<isize> = -3..2;

/// A column that the position follows, and how many rows before it.
#[derive(Debug)]
struct Input {
    values: Vec<f64>,
    lags: Range<isize>,
}

/// Position on its own past, the command's past, its velocities where they are known, and a constant (an ARX model: Ljung, System
/// Identification, 4.2), position and command less the position's mean.
#[derive(Debug)]
pub(super) struct Regression {
    position: Vec<f64>,
    inputs: Vec<Input>,
    pieces: Vec<Range<usize>>,
    /// Piece of each row.
    piece: Vec<usize>,
    /// Lags of the command.
    pub(super) lags: usize,
    /// All regressors, the constant last.
    regressors: usize,
    /// Rows between grid points.
    pub(super) step: usize,
    pub(super) rows: usize,
    /// Square of a reading's rounding: what no row is known better than.
    pub(super) rounding: f64,
    /// A count of the sensor.
    pub(super) count: f64,
    pub(super) step_s: f64,
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
    /// Rows by which the inputs are late.
    shift: f64,
}

impl Regression {
    /// Of a joint beside its command, and beside its velocities too where they are given.
    pub(super) fn new(series: &Series, velocity: Option<&[f64]>) -> Self {
        let middle = mean(&series.response);
        let rows = series.len();
        let pieces: Vec<Range<usize>> = series.pieces().collect();
        let mut piece = vec![0; rows];
        for (index, range) in pieces.iter().enumerate() {
            piece[range.clone()].fill(index);
        }
        let lags = ((MEMORY_S / series.step_s).round() as usize).clamp(6, MOST_LAGS);
        let mut inputs = vec![Input {
            values: series.command.iter().map(|value| value - middle).collect(),
            lags: 0..lags as isize,
        }];
        inputs.extend(velocity.map(|velocity| Input {
            values: velocity.to_vec(),
            lags: VELOCITY_LAGS,
        }));
        let columns: usize = inputs.iter().map(|input| input.lags.len()).sum();
        Self {
            position: series.response.iter().map(|value| value - middle).collect(),
            regressors: ORDER + columns + 1,
            inputs,
            pieces,
            piece,
            lags,
            step: (rows / MOST_POINTS).max(LEAST_STEP),
            rows,
            // two readings of each row, each rounded
            rounding: 2.0 * series.count * series.count / 12.0,
            count: series.count,
            step_s: series.step_s,
        }
    }

    /// Number of regressors, the constant last.
    pub(super) fn regressors(&self) -> usize {
        self.regressors
    }

    /// Whether the memory of a row lies within its piece.
    fn has_past(&self, row: usize) -> bool {
        row >= self.pieces[self.piece[row]].start + self.lags
    }

    /// The regressors of a row with its inputs as they were `shift` rows before, between rows along straight lines, then the
    /// target; none where the row has no past.
    fn row(&self, row: usize, shift: f64) -> Option<[f64; MOST_COLUMNS]> {
        if !self.has_past(row) {
            return None;
        }
        let own = &self.pieces[self.piece[row]];
        let mut values = [0.0; MOST_COLUMNS];
        for (past, value) in values[..ORDER].iter_mut().enumerate() {
            *value = self.position[row - past - 1];
        }
        let (whole, part) = (shift.floor(), shift - shift.floor());
        let mut column = ORDER;
        for input in &self.inputs {
            let at = |row: isize| {
                input.values[row.clamp(own.start as isize, own.end as isize - 1) as usize]
            };
            for lag in input.lags.clone() {
                let late = row as isize - lag - whole as isize;
                values[column] = match part > 0.0 {
                    true => (1.0 - part) * at(late) + part * at(late - 1),
                    false => at(late),
                };
                column += 1;
            }
        }
        values[column] = 1.0;
        values[column + 1] = self.position[row];
        Some(values)
    }

    fn add(&self, row: usize, shift: f64, sums: &mut Sums) {
        if let Some(values) = self.row(row, shift) {
            sums.add(&values[..=self.regressors]);
        }
    }

    /// Sums up to each grid point.
    pub(super) fn prefix(&self, shift: f64) -> Prefix {
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

    /// Sums of a stretch of rows, one after the other.
    pub(super) fn of_rows(&self, rows: Range<usize>, shift: f64) -> Sums {
        let mut sums = Sums::zeros(self.regressors() + 1);
        rows.for_each(|row| self.add(row, shift, &mut sums));
        sums
    }

    /// What the fit of some sums predicts of a row.
    pub(super) fn predicted(&self, solution: &[f64], row: usize, shift: f64) -> Option<f64> {
        let values = self.row(row, shift)?;
        let pairs = values[..self.regressors].iter().zip(solution);
        Some(pairs.map(|(value, coefficient)| value * coefficient).sum())
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

    /// Rows that were added: the constant's square.
    pub(super) fn rows(&self) -> f64 {
        self.at(self.size - 2, self.size - 2)
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
