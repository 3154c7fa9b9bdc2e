//! Rows of tables.

use haptical_report::Cell;

/// A row of a table: words, and numbers, counts or intervals with the decimals that people see of them.
/// `cells! { "offset", 2.5 => 3, None::<f64> => 1, [1.0, 2.0] => 2 }` is a row of four.
#[macro_export]
macro_rules! cells {
    (@ $value:expr) => { $crate::Cell::from($value) };
    (@ $value:expr, $decimals:expr) => { $crate::Shown::shown($value, $decimals) };
    ($($value:expr $(=> $decimals:expr)?),+ $(,)?) => {
        vec![$($crate::cells!(@ $value $(, $decimals)?)),+]
    };
}

/// A number that a cell shows, an interval, or none.
pub trait Shown {
    /// The cell, with so many digits after the point.
    fn shown(self, decimals: usize) -> Cell;
}

impl Shown for f64 {
    fn shown(self, decimals: usize) -> Cell {
        Cell::number(self, decimals)
    }
}

impl Shown for usize {
    fn shown(self, decimals: usize) -> Cell {
        Cell::number(self as f64, decimals)
    }
}

impl Shown for u64 {
    fn shown(self, decimals: usize) -> Cell {
        Cell::number(self as f64, decimals)
    }
}

impl Shown for [f64; 2] {
    fn shown(self, decimals: usize) -> Cell {
        Cell::interval(self[0], self[1], decimals)
    }
}

impl<T: Shown> Shown for Option<T> {
    fn shown(self, decimals: usize) -> Cell {
        self.map_or(Cell::Missing, |value| value.shown(decimals))
    }
}
