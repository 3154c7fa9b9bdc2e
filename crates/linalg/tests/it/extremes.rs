//! Matrices at the edges of shape and of floating point: an error or finite numbers, never a panic.

use haptical_linalg::{LinalgError, Matrix, RANK_TOLERANCE, Reduction, singular_values};
use proptest::prelude::*;

use crate::support::all_columns;

fn finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

fn columns_finite(matrix: &Matrix) -> bool {
    (0..matrix.columns()).all(|column| finite(matrix.column(column)))
}

/// Asks everything of a matrix; whatever is answered must be finite.
fn interrogate(matrix: &Matrix, rhs: &[f64]) -> Result<Reduction, LinalgError> {
    if let Ok(values) = singular_values(matrix) {
        assert!(finite(&values));
        assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
    }
    let reduction = Reduction::new(matrix, rhs)?;
    assert!(finite(reduction.column_norms()));
    let columns = all_columns(matrix);
    for damping in [0.0, 1e-12, 1.0, 1e12] {
        if let Ok(step) = reduction.solve(&columns, damping, 1e-12) {
            assert!(finite(&step.values));
            assert!(step.residual_square.is_finite() && step.residual_square >= 0.0);
            assert!(step.explained_square.is_finite());
        }
    }
    if let Ok(covariance) = reduction.covariance(&columns, 1e-12) {
        assert!(columns_finite(&covariance));
    }
    if let Ok((values, vectors)) = reduction.singular_values(&columns) {
        assert!(finite(&values) && columns_finite(&vectors));
    }
    if let Ok(rank) = reduction.ordered_rank(&columns, RANK_TOLERANCE) {
        let listed = rank.independent.len() + rank.zero.len() + rank.dependent.len();
        assert_eq!(listed, columns.len());
        for dependence in &rank.dependent {
            for (_, value) in &dependence.combination {
                assert!(value.is_finite());
            }
        }
    }
    Ok(reduction)
}

#[test]
fn zero_matrix_has_rank_zero() {
    for (rows, columns) in [(1, 1), (5, 3), (3, 5), (300, 12)] {
        let matrix = Matrix::zeros(rows, columns);
        let reduction = interrogate(&matrix, &vec![1.0; rows]).unwrap();
        let order = all_columns(&matrix);
        let rank = reduction.ordered_rank(&order, RANK_TOLERANCE).unwrap();
        assert_eq!(rank.zero, order);
        let solution = reduction.solve(&order, 0.0, RANK_TOLERANCE).unwrap();
        assert_eq!(solution.rank, 0);
        assert!(solution.values.iter().all(|value| *value == 0.0));
        assert!((solution.residual_square - rows as f64).abs() < 1e-12);
        assert!(reduction.covariance(&order, RANK_TOLERANCE).is_err());
        assert!(singular_values(&matrix).unwrap().iter().all(|v| *v == 0.0));
    }
}

#[test]
fn wide_matrix_keeps_as_many_columns_as_rows() {
    let matrix = Matrix::from_fn(3, 5, |row, column| {
        ((row * row + 3 * row * column + column) as f64).sin()
    });
    let reduction = interrogate(&matrix, &[1.0, 2.0, 3.0]).unwrap();
    let rank = reduction
        .ordered_rank(&[4, 3, 2, 1, 0], RANK_TOLERANCE)
        .unwrap();
    assert_eq!(rank.independent, [4, 3, 2]);
    assert_eq!(rank.dependent.len(), 2);
    let order = all_columns(&matrix);
    let solution = reduction.solve(&order, 0.0, RANK_TOLERANCE).unwrap();
    assert_eq!(solution.rank, 3);
    assert!(solution.residual_square < 1e-20);
    assert!(matches!(
        reduction.covariance(&order, RANK_TOLERANCE),
        Err(LinalgError::RankDeficient {
            rank: 3,
            columns: 5
        })
    ));
}

#[test]
fn one_row_and_one_column() {
    let row = Matrix::from_fn(1, 3, |_, column| [0.0, 4.0, 2.0][column]);
    let reduction = interrogate(&row, &[8.0]).unwrap();
    let rank = reduction.ordered_rank(&[0, 1, 2], RANK_TOLERANCE).unwrap();
    assert_eq!(
        (rank.zero, rank.independent, rank.dependent[0].column),
        (vec![0], vec![1], 2)
    );
    assert!((rank.dependent[0].combination[0].1 - 0.5).abs() < 1e-15);
    assert!((reduction.solve(&[1], 0.0, 1e-9).unwrap().values[0] - 2.0).abs() < 1e-15);

    let column = Matrix::from_fn(4, 1, |row, _| row as f64);
    let reduction = interrogate(&column, &[1.0, 2.0, 3.0, 4.0]).unwrap();
    // Slope through the origin: (0 + 2 + 6 + 12) / (0 + 1 + 4 + 9).
    let solution = reduction.solve(&[0], 0.0, RANK_TOLERANCE).unwrap();
    assert!((solution.values[0] - 20.0 / 14.0).abs() < 1e-14);
    let covariance = reduction.covariance(&[0], RANK_TOLERANCE).unwrap();
    assert!((covariance[(0, 0)] - 1.0 / 14.0).abs() < 1e-15);
}

#[test]
fn columns_of_any_unit_are_solved() {
    // The same line in units 1e±150 apart: squares of the norms fit into doubles.
    for unit in [1e-150, 1e-12, 1e12, 1e150] {
        let matrix = Matrix::from_fn(5, 2, |row, column| [1.0, unit * row as f64][column]);
        let rhs: Vec<f64> = (0..5).map(|row| 2.0 + 3.0 * f64::from(row)).collect();
        let reduction = interrogate(&matrix, &rhs).unwrap();
        let solution = reduction.solve(&[0, 1], 0.0, RANK_TOLERANCE).unwrap();
        assert!((solution.values[0] - 2.0).abs() < 1e-13);
        assert!((solution.values[1] * unit - 3.0).abs() < 1e-13);
    }
}

#[test]
fn what_no_double_can_hold_is_refused() {
    let overflow = |result: Result<Reduction, LinalgError>| {
        assert!(matches!(result, Err(LinalgError::Overflow { .. })));
    };
    overflow(Reduction::new(
        &Matrix::from_fn(4, 1, |_, _| 1.7e308),
        &[0.0; 4],
    ));
    overflow(Reduction::new(
        &Matrix::from_fn(4, 1, |_, _| 1.0),
        &[1e300; 4],
    ));
    let tiny = Reduction::new(&Matrix::from_fn(4, 1, |_, _| 1e-300), &[1e20; 4]).unwrap();
    assert!(matches!(
        tiny.solve(&[0], 0.0, 1e-9),
        Err(LinalgError::Overflow { .. })
    ));
    assert!(matches!(
        tiny.covariance(&[0], 1e-9),
        Err(LinalgError::Overflow { .. })
    ));
}

fn entry() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1.0..1.0_f64,
        2 => Just(0.0),
        1 => Just(1e300),
        1 => Just(-1e300),
        1 => Just(1e-300),
        1 => Just(5e-324),
        1 => Just(f64::MAX),
        1 => -1e-17..1e-17_f64,
    ]
}

proptest! {
    #![proptest_config(crate::support::cases(256))]

    #[test]
    fn any_finite_matrix_gets_a_finite_answer_or_an_error(
        rows in 1..9_usize,
        columns in 1..7_usize,
        entries in prop::collection::vec(entry(), 54),
        rhs in prop::collection::vec(entry(), 9),
    ) {
        let matrix = Matrix::from_fn(rows, columns, |row, column| entries[row * 6 + column]);
        let _ = interrogate(&matrix, &rhs[..rows]);
        let _ = interrogate(&matrix, &vec![1.0; rows]);
    }
}
