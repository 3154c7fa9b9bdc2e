//! A space of directions that grows: what is left of a vector beside it.

use haptical_linalg::{dot, take_off};

/// What is left of a column beside those before it, relative to its length, is nothing below this.
const DEPENDENT: f64 = 1e-7;
/// A column of which no more than this share of the square is beside the base model is not told apart from it.
const ABSORBED: f64 = 1e-6;

/// A column of rows: of one channel alone, or of all.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Column {
    /// Zero but from this row on.
    Part {
        first: usize,
        values: Vec<f64>,
    },
    All(Vec<f64>),
}

impl Column {
    /// Where it begins, and its values.
    pub(crate) fn parts(&self) -> (usize, &[f64]) {
        match self {
            Self::Part { first, values } => (*first, values),
            Self::All(values) => (0, values),
        }
    }

    /// Product with a vector.
    pub(crate) fn dot(&self, vector: &[f64]) -> f64 {
        let (first, values) = self.parts();
        dot(values, &vector[first..])
    }

    /// Product with another column.
    pub(crate) fn times(&self, other: &Self) -> f64 {
        let ((a, x), (b, y)) = (self.parts(), other.parts());
        let from = a.max(b);
        let to = (a + x.len()).min(b + y.len());
        match from < to {
            true => dot(&x[from - a..to - a], &y[from - b..to - b]),
            false => 0.0,
        }
    }

    /// Adds a multiple of it to a vector.
    pub(crate) fn add_to(&self, vector: &mut [f64], factor: f64) {
        let (first, values) = self.parts();
        for (into, value) in vector[first..].iter_mut().zip(values) {
            *into += factor * value;
        }
    }

    fn dense(&self, length: usize) -> Vec<f64> {
        let mut all = vec![0.0; length];
        self.add_to(&mut all, 1.0);
        all
    }
}

/// Orthonormal directions of columns (Gram-Schmidt, each taken off twice: Giraud, Langou and Rozloznik 2005).
#[derive(Debug, Clone, Default)]
pub(crate) struct Span {
    directions: Vec<Vec<f64>>,
    /// For each column its parts along the directions up to its own; none for one that depends on those before it.
    factors: Vec<Option<Vec<f64>>>,
}

/// What columns would explain beside a span.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Gain {
    /// Half the square that they take off.
    pub(crate) nats: f64,
    /// How many of them the rows tell apart from the span and each other.
    pub(crate) rank: usize,
    /// The columns' coefficients, 0 of those that are not told apart.
    pub(crate) coefficients: Vec<f64>,
}

impl Span {
    /// Directions there are.
    pub(crate) fn rank(&self) -> usize {
        self.directions.len()
    }

    /// What of a vector is beside all directions.
    pub(crate) fn rest_of(&self, mut vector: Vec<f64>) -> Vec<f64> {
        for direction in &self.directions {
            take_off(&mut vector, direction);
        }
        vector
    }

    /// Adds a column of a space of `length` rows; false where it depends on those that are there.
    pub(crate) fn add(&mut self, column: &Column, length: usize) -> bool {
        let mut rest = column.dense(length);
        let before = dot(&rest, &rest).sqrt();
        let mut factors: Vec<f64> = vec![0.0; self.directions.len()];
        for _ in 0..2 {
            for (factor, direction) in factors.iter_mut().zip(&self.directions) {
                *factor += take_off(&mut rest, direction);
            }
        }
        let left = dot(&rest, &rest).sqrt();
        if !(left > DEPENDENT * before) {
            self.factors.push(None);
            return false;
        }
        rest.iter_mut().for_each(|value| *value /= left);
        factors.push(left);
        self.directions.push(rest);
        self.factors.push(Some(factors));
        true
    }

    /// Coefficients of all columns for a vector: 0 for those that depend on others.
    pub(crate) fn solve(&self, vector: &[f64]) -> Vec<f64> {
        let mut along: Vec<f64> = self.directions.iter().map(|own| dot(own, vector)).collect();
        let mut found = vec![0.0; self.factors.len()];
        for (column, factors) in self.factors.iter().enumerate().rev() {
            let Some((last, before)) = factors.as_ref().and_then(|own| own.split_last()) else {
                continue;
            };
            let value = along[before.len()] / last;
            found[column] = value;
            for (along, factor) in along.iter_mut().zip(before) {
                *along -= value * factor;
            }
        }
        found
    }

    /// Rows of the inverse factor for some columns: the scalar products of two of them are the covariances of the columns'
    /// coefficients.
    pub(crate) fn inverse_rows(&self, columns: &[usize]) -> Vec<Vec<f64>> {
        let rank = self.rank();
        let mut rows = vec![vec![0.0; rank]; columns.len()];
        for direction in 0..rank {
            // the solution for the unit vector along a direction
            let mut along = vec![0.0; rank];
            along[direction] = 1.0;
            for (column, factors) in self.factors.iter().enumerate().rev() {
                let Some((last, before)) = factors.as_ref().and_then(|own| own.split_last()) else {
                    continue;
                };
                let value = along[before.len()] / last;
                if let Some(row) = columns.iter().position(|own| *own == column) {
                    rows[row][direction] = value;
                }
                for (along, factor) in along.iter_mut().zip(before) {
                    *along -= value * factor;
                }
            }
        }
        rows
    }
}

/// Columns with their products among each other and with a span's directions, which every look at a rest needs again.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    /// Products with each direction of the span, column by column.
    along: Vec<Vec<f64>>,
    /// Products of two columns.
    products: Vec<Vec<f64>>,
}

impl Prepared {
    pub(crate) fn new(span: &Span, columns: &[Column]) -> Self {
        let along = |column: &Column| span.directions.iter().map(|own| column.dot(own)).collect();
        let products = |column: &Column| columns.iter().map(|own| own.times(column)).collect();
        Self {
            along: columns.iter().map(along).collect(),
            products: columns.iter().map(products).collect(),
        }
    }

    /// What the columns would explain of a rest that is beside the span and further directions, which are beside it too.
    pub(crate) fn gain(&self, columns: &[Column], further: &Span, rest: &[f64]) -> Gain {
        let count = columns.len();
        let beside: Vec<Vec<f64>> = (columns.iter())
            .map(|column| {
                further
                    .directions
                    .iter()
                    .map(|own| column.dot(own))
                    .collect()
            })
            .collect();
        // the Gram matrix of what is beside all directions, reduced as it is made
        let mut factor = vec![vec![0.0; count]; count];
        let mut values = vec![0.0; count];
        let mut found = Gain {
            coefficients: vec![0.0; count],
            ..Gain::default()
        };
        for i in 0..count {
            let within =
                |j: usize| dot(&self.along[i], &self.along[j]) + dot(&beside[i], &beside[j]);
            let whole = self.products[i][i];
            for j in 0..i {
                if factor[j][j] != 0.0 {
                    let product = self.products[i][j] - within(j);
                    factor[i][j] = (product - dot(&factor[i][..j], &factor[j][..j])) / factor[j][j];
                }
            }
            let left = whole - within(i) - dot(&factor[i][..i], &factor[i][..i]);
            if !(left > ABSORBED * whole) {
                continue;
            }
            factor[i][i] = left.sqrt();
            values[i] = (columns[i].dot(rest) - dot(&factor[i][..i], &values[..i])) / factor[i][i];
            found.nats += 0.5 * values[i] * values[i];
            found.rank += 1;
        }
        for i in (0..count).rev().filter(|i| factor[*i][*i] != 0.0) {
            let later = (i + 1..count)
                .map(|j| factor[j][i] * found.coefficients[j])
                .sum::<f64>();
            found.coefficients[i] = (values[i] - later) / factor[i][i];
        }
        found
    }
}

/// What columns would explain of a rest that is beside a span.
pub(crate) fn gain(span: &Span, columns: &[Column], rest: &[f64]) -> Gain {
    Prepared::new(span, columns).gain(columns, &Span::default(), rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(values: &[f64]) -> Column {
        Column::All(values.to_vec())
    }

    #[test]
    fn a_gain_is_what_a_fit_takes_off() {
        let mut span = Span::default();
        assert!(span.add(&all(&[1.0; 4]), 4));
        assert!(!span.add(&all(&[2.0; 4]), 4));
        let rest = span.rest_of(vec![1.0, 2.0, 3.0, 5.0]);
        // a line through 1, 2, 3, 5 by least squares: slope 1.3, of 8.75 squares 0.3 are left
        let columns = [all(&[0.0, 1.0, 2.0, 3.0]), all(&[3.0, 2.0, 1.0, 0.0])];
        let found = gain(&span, &columns, &rest);
        assert_eq!(found.rank, 1);
        assert!((found.nats - 0.5 * (8.75 - 0.3)).abs() < 1e-12, "{found:?}");
        assert!((found.coefficients[0] - 1.3).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn coefficients_and_covariances_are_those_of_least_squares() {
        let mut span = Span::default();
        let slope = Column::Part {
            first: 1,
            values: vec![1.0, 2.0, 3.0],
        };
        for column in [all(&[1.0; 4]), all(&[3.0; 4]), slope] {
            span.add(&column, 4);
        }
        let found = span.solve(&[1.0, 2.0, 3.0, 5.0]);
        for (found, wanted) in found.iter().zip([0.8, 0.0, 1.3]) {
            assert!((found - wanted).abs() < 1e-12, "{found}");
        }
        // (X'X)^-1 of 1 and 0 to 3: 0.7, -0.3, 0.2
        let rows = span.inverse_rows(&[0, 2]);
        for ((a, b), wanted) in [((0, 0), 0.7), ((0, 1), -0.3), ((1, 1), 0.2)] {
            assert!((dot(&rows[a], &rows[b]) - wanted).abs() < 1e-12);
        }
    }
}
