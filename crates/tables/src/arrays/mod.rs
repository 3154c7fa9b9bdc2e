//! Arrays of NumPy and MATLAB to columns: an array's first axis is the row, the other axes are its elements.

mod mat;
mod npy;
#[cfg(feature = "archives")]
mod npz;

pub(crate) use self::mat::{MAT_MAGIC, mat};
pub(crate) use self::npy::{NPY_MAGIC, npy};
#[cfg(feature = "archives")]
pub(crate) use self::npz::{limited_entries, npz, zip_names};

use haptical_data::{MOST_COLUMNS, MOST_MEMORY_BYTES};

use crate::error::TableError;
use crate::mapping::Reading;
use crate::table::{Column, Table};

/// Most numbers of a file.
pub(crate) const MOST_NUMBERS: usize = (MOST_MEMORY_BYTES / 16) as usize;

/// An array of numbers, its last axis fastest; of rank 1 or more.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    pub(crate) name: String,
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl Array {
    /// The array of values whose first axis is fastest, as Fortran and MATLAB keep them.
    pub(crate) fn from_first_axis_fastest(name: String, shape: Vec<usize>, values: &[f64]) -> Self {
        let mut turned = Vec::with_capacity(values.len());
        let mut index = vec![0; shape.len()];
        for _ in 0..values.len() {
            let place = index.iter().zip(&shape).rev();
            let place = place.fold(0, |place, (index, length)| place * length + index);
            turned.push(values[place]);
            for axis in (0..shape.len()).rev() {
                index[axis] += 1;
                if index[axis] < shape[axis] {
                    break;
                }
                index[axis] = 0;
            }
        }
        Self {
            name,
            shape,
            values: turned,
        }
    }

    /// The array with its last axis first.
    fn with_last_axis_first(self) -> Self {
        let Some((&last, front)) = self.shape.split_last() else {
            return self;
        };
        let elements: usize = front.iter().product();
        let turned = (0..last).flat_map(|row| (0..elements).map(move |element| (row, element)));
        let values = turned.map(|(row, element)| self.values[element * last + row]);
        Self {
            values: values.collect(),
            shape: [&[last], front].concat(),
            name: self.name,
        }
    }

    /// Whether it is matrices one behind the other, as MATLAB keeps them.
    fn is_matrices(&self) -> bool {
        match self.shape[..] {
            [3, 3 | 4, last] | [4, 4, last] => last != 3 && last != 4,
            _ => false,
        }
    }

    /// Whether its last axis is likelier the row than its first one: matrices, and fewer rows than columns where the file has as
    /// many rows as this one columns.
    fn has_rows_last(&self, counts: &[usize]) -> bool {
        match self.shape[..] {
            [first, last] => first < last && counts.contains(&last),
            _ => self.is_matrices(),
        }
    }

    fn columns(&self) -> Vec<Column> {
        let elements: usize = self.shape.iter().skip(1).product();
        let of = |element: usize| {
            let cells = self.values.iter().skip(element).step_by(elements.max(1));
            cells.copied().collect::<Vec<f64>>()
        };
        match elements {
            1 => vec![Column::numbers(&self.name, of(0))],
            _ => (0..elements)
                .map(|element| {
                    Column::numbers(format!("{}[{}]", self.name, element + 1), of(element))
                })
                .collect(),
        }
    }
}

/// How many rows a file's arrays may have: their first axes; the last one of matrices, and that of all where they share no other.
fn row_counts(arrays: &[Array]) -> Vec<usize> {
    let shared = |axis: fn(&Array) -> Option<&usize>| {
        let mut all = arrays.iter().map(axis);
        let first = all.next().flatten().copied();
        first.filter(|first| all.all(|own| own == Some(first)))
    };
    let last = match shared(|array| array.shape.first()) {
        Some(_) => None,
        None => shared(|array| array.shape.last()),
    };
    let own = arrays.iter().filter_map(|array| match array.is_matrices() {
        true => array.shape.last().copied(),
        false => array.shape.first().copied(),
    });
    own.chain(last).collect()
}

/// The columns of a file's arrays. A row of MATLAB (1 x n) is a column; with `transpose` the last axis is the row, without a word on
/// it where that is likelier.
pub(crate) fn to_table(
    arrays: Vec<Array>,
    name: &str,
    reading: &Reading,
) -> Result<Table, TableError> {
    let mut table = Table {
        file: name.to_owned(),
        is_named: true,
        ..Table::default()
    };
    let counts = row_counts(&arrays);
    for array in arrays {
        let is_turned = match reading.transpose {
            Some(turned) => turned,
            None => array.has_rows_last(&counts),
        };
        if is_turned && reading.transpose.is_none() {
            let shape: Vec<String> = array.shape.iter().map(usize::to_string).collect();
            table.notes.push(format!(
                "array `{}` is {}: its last axis is taken for the row; `transpose = false` takes the first one",
                array.name,
                shape.join(" x ")
            ));
        }
        let array = match is_turned {
            true => array.with_last_axis_first(),
            false => array,
        };
        let elements: usize = array.shape.iter().skip(1).product();
        if table.columns.len() + elements > MOST_COLUMNS {
            let what = format!("array `{}` has {elements} numbers in each row", array.name);
            let next = "say `transpose = true` in [table] where its last axis is the row";
            return Err(TableError::new("too-many-columns", what, name, next));
        }
        table.columns.extend(array.columns());
    }
    if table.columns.is_empty() {
        let what = "there is no array of numbers in the file";
        return Err(TableError::new(
            "no-rows",
            what,
            name,
            "give a file with arrays of numbers",
        ));
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_turned_not_mixed() {
        // a[i][j][k] = 100 i + 10 j + k, shape 2 x 3 x 2
        let at = |i: usize, j: usize, k: usize| (100 * i + 10 * j + k) as f64;
        let shape = vec![2, 3, 2];
        let mut fortran = Vec::new();
        for k in 0..2 {
            for j in 0..3 {
                for i in 0..2 {
                    fortran.push(at(i, j, k));
                }
            }
        }
        let array = Array::from_first_axis_fastest("a".into(), shape, &fortran);
        assert_eq!(array.values[..4], [0.0, 1.0, 10.0, 11.0]);
        assert_eq!(
            array.columns()[3].cells.numbers().unwrap(),
            [at(0, 1, 1), at(1, 1, 1)]
        );
        assert!(!array.has_rows_last(&[2]));
        let of = |shape: [usize; 2]| Array {
            name: String::new(),
            shape: shape.to_vec(),
            values: vec![0.0; shape[0] * shape[1]],
        };
        // joints and places with a posture in each column; joints, and one row of limits
        assert_eq!(row_counts(&[of([6, 40]), of([3, 40])]), [6, 3, 40]);
        assert_eq!(row_counts(&[of([60, 6]), of([6, 1])]), [60, 6]);
        assert!(of([6, 40]).has_rows_last(&[6, 3, 40]) && !of([60, 6]).has_rows_last(&[60, 6]));
        let turned = array.with_last_axis_first();
        assert_eq!(turned.shape, [2, 2, 3]);
        // row k, elements i, j
        assert_eq!(
            turned.columns()[4].cells.numbers().unwrap(),
            [at(1, 1, 0), at(1, 1, 1)]
        );
    }
}
