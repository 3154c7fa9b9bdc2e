//! A triangle is that of all rows: R^T R = J^T J, R^T q = J^T r, |q|^2 + rest = |r|^2.

use haptical_linalg::{LinalgError, Matrix, Reduction, Triangle};
use proptest::prelude::*;

use crate::support::{cases, matrix};

/// Relative to column norms: rounding of a few thousand reflections.
const ROUNDING: f64 = 1e-12;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest difference of the products of columns, relative to the columns' norms.
fn compare(triangle: &Triangle, columns: &[&[f64]], residuals: &[f64]) -> f64 {
    let count = columns.len();
    let columns: Vec<&[f64]> = columns.iter().copied().chain([residuals]).collect();
    let of_triangle = |c: usize| -> Vec<f64> {
        if c == count {
            let mut column = triangle.projected().to_vec();
            column.push(triangle.rest_square().sqrt());
            column
        } else {
            let entry = |r| if r < count { triangle.entry(r, c) } else { 0.0 };
            (0..=count).map(entry).collect()
        }
    };
    let mut worst = 0.0_f64;
    for a in 0..=count {
        for b in 0..=a {
            let scale = (dot(columns[a], columns[a]) * dot(columns[b], columns[b])).sqrt();
            let difference = dot(&of_triangle(a), &of_triangle(b)) - dot(columns[a], columns[b]);
            worst = worst.max(difference.abs() / scale.max(f64::MIN_POSITIVE));
        }
    }
    worst
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn any_rows_fold((mut jacobian, cut) in folded()) {
        let columns = jacobian.columns() - 1;
        // columns of very different sizes, and one that is zero
        for column in 0..columns {
            let size = if column == 2 && columns > 3 { 0.0 } else { 10f64.powi(column as i32 % 13 - 6) };
            jacobian.column_mut(column).iter_mut().for_each(|entry| *entry *= size);
        }
        let residuals = jacobian.column(columns).to_vec();
        let slices: Vec<&[f64]> = (0..columns).map(|c| jacobian.column(c)).collect();
        let fold = |part: std::ops::Range<usize>, into: &mut Triangle| {
            let parts: Vec<&[f64]> = slices.iter().map(|c| &c[part.clone()]).collect();
            into.fold_rows(&parts, &residuals[part]).unwrap();
        };
        // in two portions, and as two triangles
        let rows = residuals.len();
        let mut triangle = Triangle::new(columns);
        fold(0..cut, &mut triangle);
        fold(cut..rows, &mut triangle);
        let [mut merged, mut other] = [Triangle::new(columns), Triangle::new(columns)];
        fold(0..cut, &mut merged);
        fold(cut..rows, &mut other);
        merged.merge(&other).unwrap();
        for triangle in [triangle, merged] {
            prop_assert_eq!(triangle.rows(), rows);
            let worst = compare(&triangle, &slices, &residuals);
            prop_assert!(worst < ROUNDING, "{worst:e}");
            for column in 0..columns {
                for row in column + 1..columns {
                    prop_assert_eq!(triangle.entry(row, column), 0.0);
                }
            }
        }
    }
}

/// Columns with residuals as the last, and where they are cut in two.
fn folded() -> impl Strategy<Value = (Matrix, usize)> {
    (1..40_usize, 1..400_usize)
        .prop_flat_map(|(columns, rows)| (matrix(rows, columns + 1), 0..rows))
}

#[test]
fn a_triangle_refuses_numbers_that_overflow_and_slices_that_do_not_fit() {
    let fold = |columns: usize, column: &[f64], residuals: &[f64]| {
        Triangle::new(columns)
            .fold_rows(&[column], residuals)
            .unwrap_err()
    };
    for entry in [1e200, f64::NAN] {
        let refused = fold(1, &[1.0, entry], &[entry, 0.0]);
        assert!(matches!(refused, LinalgError::Overflow { .. }), "{refused}");
    }
    assert!(matches!(fold(2, &[1.0], &[0.0]), LinalgError::Shape { .. }));
    let other = Triangle::new(2);
    let refused = Triangle::new(1).merge(&other).unwrap_err();
    assert!(matches!(refused, LinalgError::Shape { .. }));
}

/// Rows of zeros make a matrix tall, which is reduced by its triangle first: what it says stays the same, of dependent columns too.
#[test]
fn a_tall_matrix_says_what_its_rows_say() {
    let number = |row: usize, column: usize| ((row * (column + 3) + column) as f64).powi(2).sin();
    for is_dependent in [false, true] {
        let mut columns: Vec<Vec<f64>> = (0..4)
            .map(|column| (0..20).map(|row| number(row, column)).collect())
            .collect();
        if is_dependent {
            columns[3] = (0..20)
                .map(|row| 2.0 * columns[0][row] - columns[1][row])
                .collect();
        }
        let rhs: Vec<f64> = (0..20).map(|row| number(row, 5)).collect();
        let reduced = |rows: usize| {
            let entry = |of: &[f64], row: usize| of.get(row).copied().unwrap_or(0.0);
            let matrix = Matrix::from_fn(rows, 4, |row, column| entry(&columns[column], row));
            let rhs: Vec<f64> = (0..rows).map(|row| entry(&rhs, row)).collect();
            Reduction::new(&matrix, &rhs).unwrap()
        };
        let (short, tall) = (reduced(20), reduced(600));
        let all: Vec<usize> = (0..4).collect();
        let [one, other] = [&short, &tall].map(|of| of.solve(&all, 0.0, 1e-10).unwrap());
        assert_eq!(one.rank, if is_dependent { 3 } else { 4 });
        assert_eq!((one.rank, tall.rows()), (other.rank, 600));
        assert!((one.explained_square - other.explained_square).abs() < 1e-12);
        let norms = short.column_norms().iter().zip(tall.column_norms());
        assert!(
            norms
                .clone()
                .all(|(one, other)| (one - other).abs() < 1e-14)
        );
        if is_dependent {
            continue;
        }
        let values = one.values.iter().zip(&other.values);
        assert!(
            values
                .clone()
                .all(|(one, other)| (one - other).abs() < 1e-12)
        );
        let [one, other] = [&short, &tall].map(|of| of.covariance(&all, 1e-10).unwrap());
        for k in 0..4 {
            assert!((one[(k, k)] / other[(k, k)] - 1.0).abs() < 1e-12, "{k}");
        }
    }
}
