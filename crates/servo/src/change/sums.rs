//! Sums of products of a regression's rows, from which any stretch of a log is fitted without going through it.

use std::cmp::Ordering;
use std::ops::Range;

use haptical_linalg::{NormalEquations, NormalSolution};

use crate::log::{Series, mean};
use crate::thresholds::{
    LEAST_STEP, MEMORY_S, MOST_LAGS, MOST_POINTS, PAST_READINGS, RIDGE, VELOCITY_LAGS,
};

/// Regressors at most, and the target.
const MOST_COLUMNS: usize = PAST_READINGS + MOST_LAGS + 5 + 2;

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

/// Sums up to each grid point.
#[derive(Debug)]
pub(super) struct Prefix {
    points: Vec<NormalEquations>,
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
            regressors: PAST_READINGS + columns + 1,
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
        for (past, value) in values[..PAST_READINGS].iter_mut().enumerate() {
            *value = self.position[row - past - 1];
        }
        let (whole, part) = (shift.floor(), shift - shift.floor());
        let mut column = PAST_READINGS;
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

    fn add(&self, row: usize, shift: f64, sums: &mut NormalEquations) {
        if let Some(values) = self.row(row, shift) {
            sums.add_row(&values[..=self.regressors]);
        }
    }

    /// Sums up to each grid point.
    pub(super) fn prefix(&self, shift: f64) -> Prefix {
        let mut at = NormalEquations::new(self.regressors());
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
    pub(super) fn up_to(&self, prefix: &Prefix, row: usize) -> NormalEquations {
        let point = (row / prefix.step).min(prefix.points.len() - 1);
        let mut sums = prefix.points[point].clone();
        for row in point * prefix.step..row {
            self.add(row, prefix.shift, &mut sums);
        }
        sums
    }

    /// Sums of a stretch of rows, one after the other.
    pub(super) fn of_rows(&self, rows: Range<usize>, shift: f64) -> NormalEquations {
        let mut sums = NormalEquations::new(self.regressors());
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

/// Rows that were added: the constant's square.
pub(super) fn rows(sums: &NormalEquations) -> f64 {
    let constant = sums.columns() - 1;
    sums.product(constant, constant)
}

/// With a further regressor, 1 on the rows of `after` and 0 on the others.
pub(super) fn with_step(sums: &NormalEquations, after: &NormalEquations) -> NormalEquations {
    let (constant, target) = (sums.columns() - 1, sums.columns());
    sums.with_column(|index| {
        let other = match index.cmp(&target) {
            Ordering::Less => index,
            Ordering::Equal => constant,
            Ordering::Greater => target,
        };
        after.product(constant, other)
    })
}

/// The fit of all regressors; the weakest directions are held by a ridge.
pub(super) fn fitted(sums: &NormalEquations) -> NormalSolution {
    let all: Vec<usize> = (0..sums.columns()).collect();
    sums.solve(&all, |column| RIDGE * sums.product(column, column))
}

#[cfg(test)]
mod tests {
    use super::{PAST_READINGS, Regression};
    use crate::log::{JointLog, Series};

    #[test]
    fn inputs_between_rows_lie_between_those_of_the_rows_before() {
        let time_s: Vec<f64> = (0..400).map(|row| 0.02 * f64::from(row)).collect();
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&time_s),
            response: &time_s,
            ..JointLog::default()
        };
        let regression = Regression::new(&Series::new(&log).unwrap(), None);
        let command = |shift: f64| regression.row(200, shift).unwrap()[PAST_READINGS];
        for shift in [0.0, 0.25, 1.0, 2.75] {
            let late = command(0.0) - command(shift);
            assert!((late - 0.02 * shift).abs() < 1e-12, "{shift}: {late}");
        }
    }
}
