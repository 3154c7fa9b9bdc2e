//! The triangle is that of all rows: R^T R = J^T J, R^T q = J^T r, |q|^2 + rest = |r|^2.

use haptical_batch::{DistanceProblem, ReducedDistance, Threads, Triangle};
use haptical_identification::{Matrix, evaluate_jacobian};
use proptest::prelude::*;

use crate::support::{case, cases, numbers, sines};

/// Relative to column norms: rounding of a few thousand reflections.
const ROUNDING: f64 = 1e-12;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest difference of the products of columns, relative to the columns' norms.
fn compare(triangle: &Triangle, jacobian: &Matrix, residuals: &[f64]) -> f64 {
    let count = jacobian.columns();
    let columns: Vec<&[f64]> = (0..count)
        .map(|c| jacobian.column(c))
        .chain([residuals])
        .collect();
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
    fn products_of_columns_are_kept(case in case(1..5000), sines in sines()) {
        let (model, poses) = (case.model(), case.batch(sines));
        let problem = DistanceProblem::new(&model, &poses).unwrap();
        let reduced = ReducedDistance::new(&model, &poses, Threads::One).unwrap();
        let free: Vec<usize> = (1..model.start().len()).collect();
        let (jacobian, residuals) = evaluate_jacobian(&problem, &model.start(), &free).unwrap();
        let worst = reduced
            .reduce(&model.start(), &free, |triangle| {
                assert_eq!(triangle.rows(), case.poses());
                compare(triangle, &jacobian, &residuals)
            })
            .unwrap();
        prop_assert!(worst < ROUNDING, "{worst:e}");
    }

    #[test]
    fn any_rows_fold(columns in 1..40_usize, rows in 1..400_usize, seed in any::<u64>()) {
        let mut number = numbers(seed);
        // columns of very different sizes, and one that is zero
        let mut jacobian = Matrix::from_fn(rows, columns, |_, column| {
            number() * 10f64.powi(column as i32 % 13 - 6)
        });
        if columns > 3 {
            jacobian.column_mut(2).fill(0.0);
        }
        let residuals: Vec<f64> = (0..rows).map(|_| number()).collect();
        let slices: Vec<&[f64]> = (0..columns).map(|c| jacobian.column(c)).collect();
        let mut triangle = Triangle::new(columns);
        // in two portions
        let cut = rows / 3;
        for part in [0..cut, cut..rows] {
            let parts: Vec<&[f64]> = slices.iter().map(|c| &c[part.clone()]).collect();
            triangle.fold_rows(&parts, &residuals[part]).unwrap();
        }
        prop_assert_eq!(triangle.rows(), rows);
        let worst = compare(&triangle, &jacobian, &residuals);
        prop_assert!(worst < ROUNDING, "{worst:e}");
        for column in 0..columns {
            for row in column + 1..columns {
                prop_assert_eq!(triangle.entry(row, column), 0.0);
            }
        }
    }
}
