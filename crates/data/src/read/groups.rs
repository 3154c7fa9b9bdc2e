//! Vectors and quaternions spread over several columns: a row has all parts or none.

use crate::column::Role;
use crate::error::place::Place;
use crate::read::assemble::{Column, Values};

/// Columns of a log from which vectors and quaternions are taken.
pub(crate) struct Groups<'a> {
    pub(crate) columns: &'a mut Vec<Column>,
    pub(crate) lines: &'a [u64],
    pub(crate) file: &'a str,
    pub(crate) warnings: &'a mut Vec<String>,
}

impl Groups<'_> {
    /// Takes the columns of one out; readings of which a part is missing are removed with a warning. None if
    /// there are no such columns or no reading is left.
    ///
    /// A position without its y is no position, and a consumer that looks at x alone would
    /// otherwise compute with `NaN`.
    pub(crate) fn take<const N: usize>(
        &mut self,
        names: &[&str; N],
        role: fn(usize) -> Role,
    ) -> Option<[Vec<f64>; N]> {
        let mut parts: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
        for (part, numbers) in parts.iter_mut().enumerate() {
            let mut columns = self.columns.iter();
            let index = columns.position(|column| column.role == role(part))?;
            if let Values::Numbers(values) = self.columns.remove(index).values {
                *numbers = values;
            }
        }
        let (file, warnings) = (self.file, &mut *self.warnings);
        let mut incomplete = Vec::new();
        let mut complete = 0_usize;
        for (row, &line) in self.lines.iter().enumerate() {
            let given = parts.iter().filter(|part| !part[row].is_nan()).count();
            if given == N {
                complete += 1;
            } else if given > 0 {
                incomplete.push(line);
                for part in &mut parts {
                    part[row] = f64::NAN;
                }
            }
        }
        let names = names.join(", ");
        if let Some(&first) = incomplete.first() {
            warnings.push(format!(
            "{}: only a part of {names} is given here and in {} further rows; these readings are \
             left out",
            Place::line(file, first),
            incomplete.len() - 1
        ));
        }
        if complete == 0 {
            warnings.push(format!(
                "{file}: no row has a reading of {names}; taken as absent"
            ));
            return None;
        }
        Some(parts)
    }
}
