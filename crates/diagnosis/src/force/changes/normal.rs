//! Normal equations of the rows of one fold and channel.

use nalgebra::{DMatrix, DVector};

use super::columns::Columns;

/// Normal equations of the rows of one fold and channel.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    pub(super) gram: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    pub(super) square: f64,
    pub(super) rows: f64,
}

impl Normal {
    /// Of some rows of a channel.
    pub(super) fn new(columns: &Columns, reading: &[f64], channel: usize, rows: &[usize]) -> Self {
        let count = columns.all.len();
        let own: Vec<f64> = rows.iter().map(|&row| reading[row]).collect();
        // columns that touch the channel, side by side
        let touching: Vec<usize> = (0..count)
            .filter(|&index| columns.all[index][channel].is_some())
            .collect();
        let dense = DMatrix::from_fn(rows.len(), touching.len(), |row, place| {
            let column = columns.all[touching[place]][channel].as_ref();
            column.map_or(0.0, |column| column[rows[row]])
        });
        let product = dense.tr_mul(&dense);
        let along = dense.tr_mul(&DVector::from_row_slice(&own));
        let mut gram = DMatrix::zeros(count, count);
        let mut right = DVector::zeros(count);
        for (a, &row) in touching.iter().enumerate() {
            right[row] = along[a];
            for (b, &column) in touching.iter().enumerate() {
                gram[(row, column)] = product[(a, b)];
            }
        }
        Self {
            gram,
            right,
            square: own.iter().map(|value| value * value).sum(),
            rows: rows.len() as f64,
        }
    }

    /// Adds columns up to `count`, all empty but the one at `place`, which is a sum of others.
    pub(super) fn add_sum(
        &mut self,
        columns: &[usize],
        numbers: &[f64],
        place: usize,
        count: usize,
    ) {
        let size = self.right.len();
        let gram = std::mem::take(&mut self.gram);
        self.gram = gram.resize(count, count, 0.0);
        self.right = std::mem::take(&mut self.right).resize_vertically(count, 0.0);
        let pairs = || columns.iter().zip(numbers);
        for row in 0..size {
            let product = pairs().map(|(&column, number)| number * self.gram[(row, column)]);
            let product = product.sum();
            self.gram[(row, place)] = product;
            self.gram[(place, row)] = product;
        }
        let square = pairs().map(|(&column, number)| number * self.gram[(place, column)]);
        self.gram[(place, place)] = square.sum();
        self.right[place] = pairs()
            .map(|(&column, number)| number * self.right[column])
            .sum();
    }

    /// Squares that numbers of some columns leave.
    pub(super) fn left(&self, columns: &[usize], numbers: &[f64]) -> f64 {
        let mut left = self.square;
        for (&column, number) in columns.iter().zip(numbers) {
            let own = self.gram.column(column);
            let others = columns.iter().zip(numbers);
            let product: f64 = others.map(|(&row, other)| own[row] * other).sum();
            left += number * (product - 2.0 * self.right[column]);
        }
        left.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of some columns, added to the equations, against equations of the columns with the sum among them.
    #[test]
    fn a_sum_of_columns_is_a_column() {
        let column = |phase: f64| -> Vec<f64> {
            (0..9)
                .map(|row| (phase + f64::from(row)).sin() + phase)
                .collect()
        };
        let own: Vec<Vec<f64>> = [0.3, 1.1, 2.5].map(column).to_vec();
        let numbers = [0.7, -1.3];
        let pairs = own[0].iter().zip(&own[2]);
        let sum = pairs
            .map(|(a, b)| numbers[0] * a + numbers[1] * b)
            .collect();
        let mut columns = Columns::default();
        for values in &own {
            columns.add(vec![Some(values.clone())], f64::INFINITY);
        }
        let reading = column(0.9);
        let rows = [0, 2, 3, 5, 8];
        let mut added = Normal::new(&columns, &reading, 0, &rows);
        added.add_sum(&[0, 2], &numbers, 4, 5);
        columns.add(vec![None], f64::INFINITY);
        columns.add(vec![Some(sum)], f64::INFINITY);
        let whole = Normal::new(&columns, &reading, 0, &rows);
        assert!((added.gram - whole.gram).amax() < 1e-12);
        assert!((added.right - whole.right).amax() < 1e-12);
    }
}
