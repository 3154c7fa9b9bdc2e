//! Columns of rows, of one channel or of all.

use haptical_linalg::dot;

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

    /// The same with the rows alone that are kept.
    pub(crate) fn masked(&self, is_kept: impl Fn(usize) -> bool) -> Self {
        let (first, values) = self.parts();
        let keep = |(k, value): (usize, &f64)| if is_kept(first + k) { *value } else { 0.0 };
        Self::Part {
            first,
            values: values.iter().enumerate().map(keep).collect(),
        }
    }

    /// Adds a multiple of it to a vector.
    pub(crate) fn add_to(&self, vector: &mut [f64], factor: f64) {
        let (first, values) = self.parts();
        for (into, value) in vector[first..].iter_mut().zip(values) {
            *into += factor * value;
        }
    }
}
