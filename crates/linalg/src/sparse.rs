//! Sparse least squares: faer's sparse QR with one symbolic analysis for many factorisations.

use faer::Mat;
use faer::prelude::SolveLstsq;
use faer::sparse::linalg::solvers::{Qr, SymbolicQr};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

use crate::LinalgError;

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
/// comes back is checked: a residual that is not orthogonal to the columns is an error.
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

impl SparseLeastSquares {
    /// Analyses the pattern given by the rows and columns of `entries` (values are ignored).
    ///
    /// # Errors
    /// [`LinalgError::Shape`] with fewer rows than columns or an index out of range,
    /// [`LinalgError::Decomposition`] if the analysis fails.
    pub fn new(rows: usize, columns: usize, entries: &[Triplet]) -> Result<Self, LinalgError> {
        if rows < columns || columns == 0 {
            return Err(LinalgError::Empty { rows, columns });
        }
        let failed = || LinalgError::Decomposition {
            what: "sparse QR analysis",
            rows,
            columns,
        };
        if let Some(entry) = entries
            .iter()
            .find(|entry| entry.row >= rows || entry.column >= columns)
        {
            return Err(LinalgError::Column {
                column: entry.column,
                columns,
            });
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
    /// [`LinalgError::RankDeficient`] if the answer is not a least-squares solution.
    pub fn solve(&self, entries: &[Triplet], rhs: &[f64]) -> Result<Vec<f64>, LinalgError> {
        self.check(entries, rhs)?;
        let values: Vec<f64> = entries.iter().map(|entry| entry.value).collect();
        let failed = || LinalgError::Decomposition {
            what: "sparse QR",
            rows: self.rows,
            columns: self.columns,
        };
        let matrix: SparseColMat<usize, f64> =
            SparseColMat::new_from_argsort(self.matrix_pattern.clone(), &self.argsort, &values)
                .map_err(|_| failed())?;
        let qr = Qr::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref())
            .map_err(|_| failed())?;
        let mut solution = Mat::from_fn(self.rows, 1, |row, _| rhs[row]);
        qr.solve_lstsq_in_place(&mut solution);
        let solution: Vec<f64> = (0..self.columns).map(|row| solution[(row, 0)]).collect();
        self.check_solution(entries, rhs, &solution)?;
        Ok(solution)
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

    /// Refuses an answer whose residual is not orthogonal to every column.
    fn check_solution(
        &self,
        entries: &[Triplet],
        rhs: &[f64],
        solution: &[f64],
    ) -> Result<(), LinalgError> {
        let mut residual = rhs.to_vec();
        for entry in entries {
            residual[entry.row] -= entry.value * solution[entry.column];
        }
        let mut gradient = vec![0.0; self.columns];
        let mut squares = vec![0.0; self.columns];
        for entry in entries {
            gradient[entry.column] += entry.value * residual[entry.row];
            squares[entry.column] += entry.value * entry.value;
        }
        let size = rhs.iter().map(|value| value * value).sum::<f64>().sqrt();
        let sound = gradient
            .iter()
            .zip(&squares)
            .all(|(slope, square)| slope.abs() <= ORTHOGONALITY_TOLERANCE * size * square.sqrt());
        let bounded = solution.iter().zip(&squares).all(|(value, square)| {
            value.is_finite() && value.abs() * square.sqrt() <= size / ORTHOGONALITY_TOLERANCE
        });
        if sound && bounded {
            Ok(())
        } else {
            Err(LinalgError::RankDeficient {
                rank: self.columns - 1,
                columns: self.columns,
            })
        }
    }
}
