//! Each error, with what it carries.

use haptical_linalg::{LinalgError, Matrix, Reduction, singular_values};

fn small() -> Matrix {
    Matrix::from_fn(4, 2, |row, column| [1.0, row as f64][column])
}

#[test]
fn entries_that_are_not_finite_are_named() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut matrix = small();
        matrix[(2, 1)] = value;
        let error = Reduction::new(&matrix, &[0.0; 4]).unwrap_err();
        assert!(matches!(
            error,
            LinalgError::NotFinite {
                row: 2,
                column: 1,
                ..
            }
        ));
        let error = singular_values(&matrix).unwrap_err();
        assert!(matches!(
            error,
            LinalgError::NotFinite {
                row: 2,
                column: 1,
                ..
            }
        ));
        let error = Reduction::new(&small(), &[0.0, 0.0, 0.0, value]).unwrap_err();
        assert!(matches!(
            error,
            LinalgError::NotFinite {
                row: 3,
                column: 2,
                ..
            }
        ));
        assert!(small().times(&[1.0, value]).is_err());
    }
}

#[test]
fn shapes_are_compared() {
    assert_eq!(
        Reduction::new(&small(), &[0.0; 3]).unwrap_err(),
        LinalgError::Shape {
            what: "right-hand side",
            expected: 4,
            found: 3
        }
    );
    for (rows, columns) in [(0, 3), (3, 0), (0, 0)] {
        let empty = Matrix::zeros(rows, columns);
        let refused = LinalgError::Empty { rows, columns };
        assert_eq!(
            Reduction::new(&empty, &vec![0.0; rows]).unwrap_err(),
            refused
        );
        assert_eq!(singular_values(&empty).unwrap_err(), refused);
    }
    assert!(small().times(&[1.0]).is_err());
    let reduction = Reduction::new(&small(), &[0.0; 4]).unwrap();
    assert!(reduction.scaled_factor(&[0, 1], &[1.0]).is_err());
    assert!(reduction.solve_weighted(&[0, 1], 1.0, &[1.0], 0.0).is_err());
}

#[test]
fn column_indices_are_checked() {
    let reduction = Reduction::new(&small(), &[0.0; 4]).unwrap();
    let repeated = LinalgError::Column {
        column: 1,
        columns: 2,
    };
    let outside = LinalgError::Column {
        column: 2,
        columns: 2,
    };
    for (columns, error) in [([1, 1], &repeated), ([0, 2], &outside)] {
        assert_eq!(&reduction.solve(&columns, 0.0, 0.0).unwrap_err(), error);
        assert_eq!(&reduction.covariance(&columns, 0.0).unwrap_err(), error);
        assert_eq!(&reduction.ordered_rank(&columns, 0.0).unwrap_err(), error);
        assert_eq!(&reduction.singular_values(&columns).unwrap_err(), error);
        let factor = reduction.scaled_factor(&columns, &[1.0, 1.0]);
        assert_eq!(&factor.unwrap_err(), error);
    }
    assert!(matches!(
        reduction.solve(&[], 0.0, 0.0),
        Err(LinalgError::Empty { .. })
    ));
}

#[test]
fn dampings_and_tolerances_have_a_range() {
    let reduction = Reduction::new(&small(), &[0.0; 4]).unwrap();
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = |what: &str, error: LinalgError| {
            assert!(
                matches!(error, LinalgError::OutOfRange { what: found, .. } if found == what),
                "{error}"
            );
        };
        refused("damping", reduction.solve(&[0], bad, 0.0).unwrap_err());
        refused("tolerance", reduction.solve(&[0], 0.0, bad).unwrap_err());
        refused("tolerance", reduction.covariance(&[0], bad).unwrap_err());
        refused("tolerance", reduction.ordered_rank(&[0], bad).unwrap_err());
        let weighted = reduction.solve_weighted(&[0], 1.0, &[bad], 0.0);
        refused("damping weight", weighted.unwrap_err());
    }
}

#[test]
fn a_row_out_of_range_does_not_read_the_next_column() {
    let matrix = small();
    let outside = std::panic::catch_unwind(|| matrix[(4, 0)]);
    assert!(outside.is_err());
}
