//! Sparse least squares: faer's sparse QR with one symbolic analysis for many factorisations.

use faer::Mat;
use faer::prelude::SolveLstsq;
use faer::sparse::linalg::solvers::{Qr, SymbolicQr};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

use crate::LinalgError;
use crate::reduction::norm;

/// One entry of a sparse matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triplet {
    /// Row, from 0.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Value.
    pub value: f64,
}

/// Solver of min |A x - b| for matrices A that share one pattern of entries.
///
/// Speed only: sparse QR has no pivoting by size and answers silently on dependent columns, so the
/// rank must be decided beforehand (with [`crate::Reduction`]) and dependent columns left out. What
/// comes back is checked twice: a residual that is not orthogonal to the columns is an error, and so
/// is a factorisation that does not return a known vector z from A z (on dependent columns any
/// vector that differs by their null space would do, which the residual alone cannot show).
///
/// ```
/// use haptical_linalg::{SparseLeastSquares, Triplet};
/// let entries: Vec<Triplet> = [(0, 0, 2.0), (1, 1, 4.0), (2, 1, 3.0)]
///     .map(|(row, column, value)| Triplet { row, column, value })
///     .to_vec();
/// let solver = SparseLeastSquares::new(3, 2, &entries)?;
/// let solution = solver.solve(&entries, &[2.0, 8.0, 6.0])?;
/// assert!((solution[0] - 1.0).abs() < 1e-14 && (solution[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), haptical_linalg::LinalgError>(())
/// ```
#[derive(Debug)]
pub struct SparseLeastSquares {
    rows: usize,
    columns: usize,
    pattern: Vec<(usize, usize)>,
    matrix_pattern: SymbolicSparseColMat<usize>,
    argsort: Argsort<usize>,
    symbolic: SymbolicQr<usize>,
}

/// Normal-equation residual, relative to |column| |b|, above which a solution is refused: a solution
/// of a full-rank problem stays near 1e-13.
const ORTHOGONALITY_TOLERANCE: f64 = 1e-8;

/// Error of the returned known vector (unit-norm columns) above which the columns count as dependent:
/// it is about 1e-16 times the condition number, and of order 1 where the rank is short.
const PROBE_TOLERANCE: f64 = 1e-6;

impl SparseLeastSquares {
    /// Analyses the pattern given by the rows and columns of `entries` (values are ignored).
    ///
    /// # Errors
    /// [`LinalgError::Empty`] without columns, [`LinalgError::Shape`] with fewer rows than columns or
    /// an index out of range, [`LinalgError::Decomposition`] if the analysis fails.
    pub fn new(rows: usize, columns: usize, entries: &[Triplet]) -> Result<Self, LinalgError> {
        if columns == 0 {
            return Err(LinalgError::Empty { rows, columns });
        }
        if rows < columns {
            return Err(LinalgError::Shape {
                what: "rows of a sparse problem (at least the columns)",
                expected: columns,
                found: rows,
            });
        }
        let failed = || LinalgError::Decomposition {
            what: "sparse QR analysis",
            rows,
            columns,
        };
        for entry in entries {
            for (what, expected, found) in [
                ("row of a sparse entry (below the rows)", rows, entry.row),
                (
                    "column of a sparse entry (below the columns)",
                    columns,
                    entry.column,
                ),
            ] {
                if found >= expected {
                    return Err(LinalgError::Shape {
                        what,
                        expected,
                        found,
                    });
                }
            }
        }
        let pattern: Vec<(usize, usize)> = entries
            .iter()
            .map(|entry| (entry.row, entry.column))
            .collect();
        let pairs: Vec<Pair<usize, usize>> = pattern
            .iter()
            .map(|&(row, column)| Pair::new(row, column))
            .collect();
        let (matrix_pattern, argsort) =
            SymbolicSparseColMat::try_new_from_indices(rows, columns, &pairs)
                .map_err(|_| failed())?;
        let symbolic = SymbolicQr::try_new(matrix_pattern.as_ref()).map_err(|_| failed())?;
        Ok(Self {
            rows,
            columns,
            pattern,
            matrix_pattern,
            argsort,
            symbolic,
        })
    }

    /// Solves with the same pattern of entries as [`SparseLeastSquares::new`] was given.
    ///
    /// # Errors
    /// [`LinalgError::Shape`] if pattern or right-hand side do not fit, [`LinalgError::NotFinite`],
    /// [`LinalgError::RankDeficient`] if the columns are dependent or the answer is not a
    /// least-squares solution, [`LinalgError::Overflow`] beyond 1e308.
    pub fn solve(&self, entries: &[Triplet], rhs: &[f64]) -> Result<Vec<f64>, LinalgError> {
        self.check(entries, rhs)?;
        let values: Vec<f64> = entries.iter().map(|entry| entry.value).collect();
        let failed = || LinalgError::Decomposition {
            what: "sparse QR",
            rows: self.rows,
            columns: self.columns,
        };
        let mut matrix: SparseColMat<usize, f64> =
            SparseColMat::new_from_argsort(self.matrix_pattern.clone(), &self.argsort, &values)
                .map_err(|_| failed())?;
        let norms = self.scale_columns(&mut matrix)?;
        let size = norm(rhs);
        if !size.is_finite() {
            return Err(LinalgError::Overflow {
                what: "the norm of the right-hand side",
            });
        }
        let unit = if size > 0.0 { size } else { 1.0 };
        let known: Vec<f64> = (0..self.columns).map(probe).collect();
        let image = product(&matrix, &known);
        let qr = Qr::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref())
            .map_err(|_| failed())?;
        let mut both = Mat::from_fn(self.rows, 2, |row, side| match side {
            0 => rhs[row] / unit,
            _ => image[row],
        });
        qr.solve_lstsq_in_place(&mut both);
        let solution: Vec<f64> = (0..self.columns).map(|row| both[(row, 0)]).collect();
        let returned =
            (0..self.columns).all(|row| (both[(row, 1)] - known[row]).abs() <= PROBE_TOLERANCE);
        if !returned || !is_least_squares(&matrix, rhs, unit, &solution) {
            return Err(self.deficient());
        }
        let solution: Vec<f64> = solution
            .iter()
            .zip(&norms)
            .map(|(value, norm)| value / norm * unit)
            .collect();
        if solution.iter().all(|value| value.is_finite()) {
            Ok(solution)
        } else {
            Err(LinalgError::Overflow { what: "a solution" })
        }
    }

    /// Brings every column to unit norm and returns the norms.
    fn scale_columns(
        &self,
        matrix: &mut SparseColMat<usize, f64>,
    ) -> Result<Vec<f64>, LinalgError> {
        let mut norms = Vec::with_capacity(self.columns);
        for column in 0..self.columns {
            let values = matrix.val_of_col_mut(column);
            let size = norm(values);
            if size == 0.0 {
                return Err(self.deficient());
            }
            if !size.is_finite() {
                return Err(LinalgError::Overflow {
                    what: "a column norm",
                });
            }
            values.iter_mut().for_each(|value| *value /= size);
            norms.push(size);
        }
        Ok(norms)
    }

    fn deficient(&self) -> LinalgError {
        LinalgError::RankDeficient {
            rank: self.columns - 1,
            columns: self.columns,
        }
    }

    fn check(&self, entries: &[Triplet], rhs: &[f64]) -> Result<(), LinalgError> {
        if entries.len() != self.pattern.len()
            || entries
                .iter()
                .zip(&self.pattern)
                .any(|(e, p)| (e.row, e.column) != *p)
        {
            return Err(LinalgError::Shape {
                what: "entries of the analysed pattern",
                expected: self.pattern.len(),
                found: entries.len(),
            });
        }
        if rhs.len() != self.rows {
            return Err(LinalgError::Shape {
                what: "right-hand side",
                expected: self.rows,
                found: rhs.len(),
            });
        }
        if let Some(entry) = entries.iter().find(|entry| !entry.value.is_finite()) {
            return Err(LinalgError::NotFinite {
                row: entry.row,
                column: entry.column,
                value: entry.value,
            });
        }
        match rhs.iter().position(|value| !value.is_finite()) {
            Some(row) => Err(LinalgError::NotFinite {
                row,
                column: self.columns,
                value: rhs[row],
            }),
            None => Ok(()),
        }
    }
}

/// Entry of the known vector: between 0.5 and 1.5 with either sign, without a pattern that a null
/// space could share (fractional parts of multiples of the golden ratio).
fn probe(index: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let fraction = ((index + 1) as f64 * GOLDEN).fract();
    let sign = if (index as f64 * GOLDEN * GOLDEN).fract() < 0.5 {
        -1.0
    } else {
        1.0
    };
    sign * (0.5 + fraction)
}

fn product(matrix: &SparseColMat<usize, f64>, vector: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; matrix.nrows()];
    for (column, factor) in vector.iter().enumerate() {
        let rows = matrix.as_ref().row_idx_of_col(column);
        for (row, value) in rows.zip(matrix.as_ref().val_of_col(column)) {
            result[row] += value * factor;
        }
    }
    result
}

/// Whether the residual is orthogonal to every (unit-norm) column, relative to the right-hand side.
fn is_least_squares(
    matrix: &SparseColMat<usize, f64>,
    rhs: &[f64],
    unit: f64,
    solution: &[f64],
) -> bool {
    let mut residual = product(matrix, solution);
    for (value, rhs) in residual.iter_mut().zip(rhs) {
        *value = rhs / unit - *value;
    }
    (0..matrix.ncols()).all(|column| {
        let rows = matrix.as_ref().row_idx_of_col(column);
        let slope: f64 = rows
            .zip(matrix.as_ref().val_of_col(column))
            .map(|(row, value)| value * residual[row])
            .sum();
        // Not `>`: a NaN must be refused.
        slope.abs() <= ORTHOGONALITY_TOLERANCE
    })
}
