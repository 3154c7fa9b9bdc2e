//! Sparse least squares against the dense reduction on block-arrow patterns.

use haptical_linalg::{
    LinalgError, Matrix, RANK_TOLERANCE, Reduction, SparseLeastSquares, Triplet,
};
use proptest::prelude::*;

use crate::support::{all_columns, condition, relative_difference};

const AGREEMENT: f64 = 1e-9;
const WORST_CONDITION: f64 = 1e3;

/// Blocks of rows, each with columns of its own and `shared` columns of all.
#[derive(Debug, Clone)]
struct Arrow {
    entries: Vec<Triplet>,
    rows: usize,
    columns: usize,
    rhs: Vec<f64>,
}

impl Arrow {
    fn dense(&self) -> Matrix {
        let mut matrix = Matrix::zeros(self.rows, self.columns);
        for entry in &self.entries {
            matrix[(entry.row, entry.column)] += entry.value;
        }
        matrix
    }

    fn sparse(&self) -> Result<Vec<f64>, LinalgError> {
        SparseLeastSquares::new(self.rows, self.columns, &self.entries)?
            .solve(&self.entries, &self.rhs)
    }
}

fn arrow() -> impl Strategy<Value = Arrow> {
    (1..6_usize, 1..4_usize, 1..4_usize, 1..5_usize).prop_flat_map(
        |(blocks, own, shared, extra)| {
            let height = own + shared + extra;
            let rows = blocks * height;
            let columns = blocks * own + shared;
            let count = rows * (own + shared);
            (
                prop::collection::vec(-1.0..1.0_f64, count),
                prop::collection::vec(-1.0..1.0_f64, rows),
            )
                .prop_map(move |(values, rhs)| {
                    let entries = (0..rows)
                        .flat_map(|row| (0..own + shared).map(move |k| (row, k)))
                        .zip(values)
                        .map(|((row, k), value)| Triplet {
                            row,
                            column: if k < own {
                                row / height * own + k
                            } else {
                                blocks * own + k - own
                            },
                            value,
                        })
                        .collect();
                    Arrow {
                        entries,
                        rows,
                        columns,
                        rhs,
                    }
                })
        },
    )
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn sparse_agrees_with_dense(case in arrow(), exponents in prop::collection::vec(-8.0..8.0_f64, 20)) {
        let mut case = case;
        prop_assume!(condition(&case.dense()) < WORST_CONDITION);
        for entry in &mut case.entries {
            entry.value *= 10.0_f64.powf(exponents[entry.column]);
        }
        let dense = case.dense();
        let reduction = Reduction::new(&dense, &case.rhs).unwrap();
        let reference = reduction.solve(&all_columns(&dense), 0.0, RANK_TOLERANCE).unwrap();
        let solution = case.sparse().unwrap();
        // In units of each column.
        let unit = |values: &[f64]| -> Vec<f64> {
            values.iter().zip(reduction.column_norms()).map(|(x, norm)| x * norm).collect()
        };
        let difference = relative_difference(&unit(&solution), &unit(&reference.values));
        prop_assert!(difference < AGREEMENT, "{}", difference);
    }

    /// One analysis serves other values, other right-hand sides and entries given in parts.
    #[test]
    fn the_analysis_is_reused(case in arrow(), factor in 0.5..2.0_f64) {
        prop_assume!(condition(&case.dense()) < WORST_CONDITION);
        let mut halves = case.clone();
        halves.entries = case.entries.iter().flat_map(|entry| {
            let part = |share: f64| Triplet { value: share * entry.value, ..*entry };
            [part(0.25), part(0.75)]
        }).collect();
        let solver = SparseLeastSquares::new(halves.rows, halves.columns, &halves.entries).unwrap();
        let reference = case.sparse().unwrap();
        let parts = solver.solve(&halves.entries, &halves.rhs).unwrap();
        prop_assert!(relative_difference(&parts, &reference) < AGREEMENT);
        for entry in &mut halves.entries {
            entry.value *= factor;
        }
        let scaled: Vec<f64> = solver.solve(&halves.entries, &halves.rhs).unwrap()
            .iter().map(|x| x * factor).collect();
        prop_assert!(relative_difference(&scaled, &reference) < AGREEMENT);
    }

    /// A column of the arrow made zero, a copy, or a combination is refused.
    #[test]
    fn deficient_patterns_are_refused(case in arrow(), kind in 0..3_usize, coefficient in 0.3..3.0_f64) {
        let mut case = case;
        let target = case.columns - 1;
        let source: Vec<f64> = (0..case.rows)
            .map(|row| {
                let own: Vec<f64> = case.entries.iter()
                    .filter(|entry| entry.row == row && entry.column != target)
                    .map(|entry| entry.value)
                    .collect();
                match kind {
                    0 => 0.0,
                    // The first own column of every block together act like the shared one.
                    1 => own[0],
                    _ => coefficient * own[0] - own[own.len() - 1],
                }
            })
            .collect();
        for entry in &mut case.entries {
            if entry.column == target {
                entry.value = source[entry.row];
            }
        }
        let refused = matches!(case.sparse(), Err(LinalgError::RankDeficient { .. }));
        prop_assert!(refused, "{:?}", case.sparse());
        // Worse to see: an exact fit, which every vector of the valley gives without a residual.
        case.rhs = case.dense().times(&vec![1.0; case.columns]).unwrap();
        let refused = matches!(case.sparse(), Err(LinalgError::RankDeficient { .. }));
        prop_assert!(refused, "{:?}", case.sparse());
    }
}

#[test]
fn a_zero_right_hand_side_gives_zero() {
    let entries: Vec<Triplet> = [(0, 0, 1.0), (1, 1, 2.0), (2, 0, 3.0)]
        .map(|(row, column, value)| Triplet { row, column, value })
        .to_vec();
    let solver = SparseLeastSquares::new(3, 2, &entries).unwrap();
    assert_eq!(solver.solve(&entries, &[0.0; 3]).unwrap(), [0.0, 0.0]);
}

#[test]
fn a_column_without_entries_is_refused() {
    let entries: Vec<Triplet> = [(0, 0, 1.0), (1, 2, 2.0), (2, 0, 3.0)]
        .map(|(row, column, value)| Triplet { row, column, value })
        .to_vec();
    let solver = SparseLeastSquares::new(3, 3, &entries).unwrap();
    assert!(matches!(
        solver.solve(&entries, &[1.0; 3]),
        Err(LinalgError::RankDeficient { .. })
    ));
}
