//! A decomposition that keeps its orthonormal basis: projections and many right-hand sides.

use std::ops::Range;

use crate::error::check_rhs;
use crate::pivoted::{back_substitute, thin_factors};
use crate::reduction::at_least_zero;
use crate::{Direction, LinalgError, Matrix, SparseColumns};

/// A = Q R of a tall matrix with its basis Q (m x rank), for projections and for right-hand sides that are
/// not known yet. [`crate::Reduction`] needs less memory where there is one right-hand side.
///
/// ```
/// use haptical_linalg::{Matrix, OrthonormalBasis, SparseColumns};
/// // the third column is the sum of the others
/// let matrix = Matrix::from_fn(4, 3, |row, column| match column {
///     0 => 1.0,
///     1 => row as f64,
///     _ => 1.0 + row as f64,
/// });
/// let basis = OrthonormalBasis::new(&SparseColumns::from(&matrix), 1e-9)?;
/// assert_eq!(basis.directions().count(), 2);
/// let x = basis.solve(&[1.0, 3.0, 5.0, 7.0])?;
/// assert!((x[0] + x[2] - 1.0).abs() < 1e-12 && (x[1] + x[2] - 2.0).abs() < 1e-12);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct OrthonormalBasis {
    rows: usize,
    parts: Vec<Part>,
    norms: Vec<f64>,
}

/// Columns that share rows, decomposed by themselves.
#[derive(Debug, Clone)]
struct Part {
    directions: Vec<Direction>,
    /// The triangle R, rank x rank.
    triangle: Matrix,
    /// The matrix's column at each of the triangle's.
    pivots: Vec<usize>,
}

impl OrthonormalBasis {
    /// Decomposes `matrix` (m x n). Columns are scaled to unit norm first; directions whose pivot is at
    /// most `tolerance` times the largest are left out, so a matrix of zeros has no directions. Columns that have no
    /// row in common with others are decomposed apart from them.
    ///
    /// # Errors
    /// [`LinalgError`] for an empty matrix, an entry that is not finite, or a column norm that
    /// overflows; [`LinalgError::OutOfRange`] for a bad tolerance.
    pub fn new(matrix: &SparseColumns, tolerance: f64) -> Result<Self, LinalgError> {
        at_least_zero("tolerance", tolerance)?;
        matrix.check()?;
        let mut norms = vec![0.0; matrix.columns()];
        let mut parts = Vec::new();
        for (rows, columns) in apart(matrix) {
            let mut own = Matrix::zeros(rows.len(), columns.len());
            for (place, &column) in columns.iter().enumerate() {
                let from = matrix.column(column);
                let first = from.first().max(rows.start);
                let values = &from.values()[first - from.first()..];
                let into = &mut own.column_mut(place)[first - rows.start..];
                for (into, value) in into.iter_mut().zip(values) {
                    *into = *value;
                }
            }
            let (scaled, own_norms) = own.into_unit_columns()?;
            for (&column, norm) in columns.iter().zip(own_norms) {
                norms[column] = norm;
            }
            let (directions, triangle, pivots) = thin_factors(&scaled, tolerance);
            let directions = (0..directions.columns()).map(|column| {
                let values = directions.column(column).to_vec();
                Direction::from_part(rows.start, values)
            });
            parts.push(Part {
                directions: directions.collect(),
                triangle,
                pivots: pivots.into_iter().map(|own| columns[own]).collect(),
            });
        }
        Ok(Self {
            rows: matrix.rows(),
            parts,
            norms,
        })
    }

    /// Orthonormal columns, as many as the rank, that span the matrix's.
    pub fn directions(&self) -> impl Iterator<Item = &Direction> {
        self.parts.iter().flat_map(|part| &part.directions)
    }

    /// The x of least |A x - b|, zero for columns that the rank cut.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] for another length, [`LinalgError::NotFinite`] for an entry that is not
    /// finite, [`LinalgError::Overflow`] for a value beyond 1e308.
    pub fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>, LinalgError> {
        check_rhs(rhs, self.rows, self.norms.len())?;
        let mut solution = vec![0.0; self.norms.len()];
        for part in &self.parts {
            let project = |direction: &Direction| -> f64 {
                let own = direction.values().iter().zip(&rhs[direction.first()..]);
                own.map(|(q, b)| q * b).sum()
            };
            let projected: Vec<f64> = part.directions.iter().map(project).collect();
            let known = back_substitute(&part.triangle, &projected);
            for (value, &column) in known.iter().zip(&part.pivots) {
                solution[column] = value / self.norms[column];
            }
        }
        if solution.iter().any(|value| !value.is_finite()) {
            return Err(LinalgError::Overflow { what: "a solution" });
        }
        Ok(solution)
    }
}

/// Ranges of rows without one in common, and the columns, ascending, that have entries in each. A matrix whose columns do
/// not fall apart is one range of all its rows; columns of zeros belong to the first.
fn apart(matrix: &SparseColumns) -> Vec<(Range<usize>, Vec<usize>)> {
    let is_there = |value: &f64| *value != 0.0;
    let mut supports: Vec<(usize, usize, usize)> = Vec::with_capacity(matrix.columns());
    let mut zeros = Vec::new();
    for column in 0..matrix.columns() {
        let own = matrix.column(column);
        let entries = own.values();
        match entries.iter().position(is_there) {
            None => zeros.push(column),
            Some(first) => {
                let last = entries.iter().rposition(is_there).unwrap_or(first);
                supports.push((own.first() + first, own.first() + last + 1, column));
            }
        }
    }
    supports.sort_unstable();
    let mut parts: Vec<(Range<usize>, Vec<usize>)> = Vec::new();
    for (first, end, column) in supports {
        match parts.last_mut() {
            Some((rows, columns)) if first < rows.end => {
                rows.end = rows.end.max(end);
                columns.push(column);
            }
            _ => parts.push((first..end, vec![column])),
        }
    }
    if parts.len() <= 1 {
        return vec![(0..matrix.rows(), (0..matrix.columns()).collect())];
    }
    parts[0].1.extend(zeros);
    for (_, columns) in &mut parts {
        columns.sort_unstable();
    }
    parts
}
