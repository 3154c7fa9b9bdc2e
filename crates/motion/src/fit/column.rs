//! Columns of rows, of one channel or of all.

use std::ops::Range;

use haptical_linalg::dot;

use crate::thresholds::fit::GAP_ROWS;

/// A column of rows: of one channel alone, or of all.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Column {
    /// Zero but from this row on.
    Part {
        first: usize,
        values: Vec<f64>,
    },
    All(Vec<f64>),
    /// The same, zero but in some spans of rows.
    Spans {
        values: Vec<f64>,
        spans: Vec<Range<usize>>,
    },
}

impl Column {
    /// The same column with the spans of rows where it is not zero: products pass over the others.
    pub(crate) fn in_spans(self) -> Self {
        let (first, values) = self.parts();
        let mut spans: Vec<Range<usize>> = Vec::new();
        for (k, _) in values.iter().enumerate().filter(|(_, own)| **own != 0.0) {
            let row = first + k;
            match spans.last_mut() {
                Some(last) if row < last.end + GAP_ROWS => last.end = row + 1,
                _ => spans.push(row..row + 1),
            }
        }
        let mut all = vec![0.0; first];
        all.extend_from_slice(values);
        Self::Spans { values: all, spans }
    }

    /// Where it begins, and its values.
    pub(crate) fn parts(&self) -> (usize, &[f64]) {
        match self {
            Self::Part { first, values } => (*first, values),
            Self::All(values) | Self::Spans { values, .. } => (0, values),
        }
    }

    /// Its value in a row.
    pub(crate) fn at_row(&self, row: usize) -> f64 {
        let (first, values) = self.parts();
        let index = row.checked_sub(first);
        index
            .and_then(|index| values.get(index))
            .map_or(0.0, |value| *value)
    }

    /// Product with a vector.
    pub(crate) fn dot(&self, vector: &[f64]) -> f64 {
        if let Self::Spans { values, spans } = self {
            let product = |own: &Range<usize>| dot(&values[own.clone()], &vector[own.clone()]);
            return spans.iter().map(product).sum();
        }
        let (first, values) = self.parts();
        dot(values, &vector[first..])
    }

    /// Product with another column.
    pub(crate) fn times(&self, other: &Self) -> f64 {
        match (self, other) {
            (Self::Spans { values, spans }, _) => spans
                .iter()
                .map(|own| other.over((own.start, &values[own.clone()])))
                .sum(),
            (_, Self::Spans { .. }) => other.times(self),
            _ => other.over(self.parts()),
        }
    }

    /// Product with values that begin at a row.
    fn over(&self, (a, x): (usize, &[f64])) -> f64 {
        let (b, y) = self.parts();
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
        let values = values.iter().enumerate().map(keep).collect();
        match self {
            Self::Spans { spans, .. } => Self::Spans {
                values,
                spans: spans.clone(),
            },
            _ => Self::Part { first, values },
        }
    }

    /// Adds a multiple of it to a vector.
    pub(crate) fn add_to(&self, vector: &mut [f64], factor: f64) {
        if let Self::Spans { values, spans } = self {
            for row in spans.iter().cloned().flatten() {
                vector[row] += factor * values[row];
            }
            return;
        }
        let (first, values) = self.parts();
        for (into, value) in vector[first..].iter_mut().zip(values) {
            *into += factor * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_change_no_product() {
        let mut values = vec![0.0; 60];
        for (row, value) in [(3, 1.0), (4, -2.0), (30, 0.5), (59, 4.0)] {
            values[row] = value;
        }
        let whole = Column::All(values);
        let spans = whole.clone().in_spans();
        assert!(matches!(&spans, Column::Spans { spans, .. } if spans.len() == 3));
        let slope: Vec<f64> = (0..60).map(f64::from).collect();
        let part = Column::Part {
            first: 4,
            values: slope[..40].to_vec(),
        };
        let other = Column::All(slope.clone());
        assert_eq!(spans.dot(&slope), whole.dot(&slope));
        for own in [&part, &other, &spans] {
            assert_eq!(spans.times(own), whole.times(own));
            assert_eq!(own.times(&spans), whole.times(own));
        }
        let mut into = slope.clone();
        let mut wanted = slope;
        spans.add_to(&mut into, 2.0);
        whole.add_to(&mut wanted, 2.0);
        assert_eq!(into, wanted);
        let is_even = |row: usize| row.is_multiple_of(2);
        let kept = whole.masked(is_even);
        assert_eq!(spans.masked(is_even).dot(&wanted), kept.dot(&wanted));
    }
}
