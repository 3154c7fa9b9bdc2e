//! A vector that is zero but for a range of its entries.

use crate::{dot, take_off};

/// Share of its length up to which a vector's range is worth a look.
const SHORT: f64 = 0.5;

/// A direction over many entries that may be zero outside a range: where the parts of a problem do not know of each
/// other, products with it cost what its own part does.
///
/// ```
/// use haptical_linalg::Direction;
/// let direction = Direction::new(vec![0.0, 0.0, 0.6, 0.8, 0.0]);
/// assert_eq!(direction.entry(3), 0.8);
/// assert_eq!(direction.entry(4), 0.0);
/// let mut vector = [1.0, 2.0, 3.0, 4.0, 5.0];
/// assert_eq!(direction.dot(&vector), 5.0);
/// direction.take_off(&mut vector);
/// assert!(direction.dot(&vector).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    first: usize,
    values: Vec<f64>,
}

impl Direction {
    /// A direction with all its entries; leading and trailing zeros are not kept where they are most of them.
    pub fn new(mut values: Vec<f64>) -> Self {
        let is_there = |value: &f64| *value != 0.0;
        let first = values.iter().position(is_there).unwrap_or(0);
        let end = values.iter().rposition(is_there).map_or(0, |last| last + 1);
        if ((end - first.min(end)) as f64) < SHORT * values.len() as f64 {
            values = values[first.min(end)..end].to_vec();
            return Self { first, values };
        }
        Self { first: 0, values }
    }

    /// A direction whose entries from `first` on are given, and zero elsewhere.
    pub fn from_part(first: usize, values: Vec<f64>) -> Self {
        Self { first, values }
    }

    /// First entry that may differ from zero.
    pub fn first(&self) -> usize {
        self.first
    }

    /// Entries from the first on that may differ from zero.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// An entry.
    #[inline]
    pub fn entry(&self, index: usize) -> f64 {
        let place = index.checked_sub(self.first);
        place
            .and_then(|place| self.values.get(place))
            .copied()
            .unwrap_or(0.0)
    }

    /// Product with a vector, whose entries before `first` count as zero where it is shorter.
    pub fn dot(&self, vector: &[f64]) -> f64 {
        dot(&self.values, vector.get(self.first..).unwrap_or(&[]))
    }

    /// The same with a part of a vector, from entry `start` on.
    pub fn dot_part(&self, part: &[f64], start: usize) -> f64 {
        let (from, to) = (start.max(self.first), start + part.len());
        let to = to.min(self.first + self.values.len());
        if from >= to {
            return 0.0;
        }
        dot(
            &self.values[from - self.first..to - self.first],
            &part[from - start..to - start],
        )
    }

    /// Takes the part along this direction, of length 1, off a vector, and returns their product.
    pub fn take_off(&self, vector: &mut [f64]) -> f64 {
        let own = vector.get_mut(self.first..).unwrap_or(&mut []);
        let count = own.len().min(self.values.len());
        take_off(&mut own[..count], &self.values[..count])
    }
}
