//! What must not depend on units, on the order of rows or on their mixing; what more data cannot do.

use haptical_identification::{Matrix, Status};
use proptest::prelude::*;

use crate::support::{judge, reduce};

/// Independent random columns and combinations of them, in a random order.
fn planted() -> impl Strategy<Value = Matrix> {
    (2..5_usize, 1..4_usize, 3..20_usize)
        .prop_flat_map(|(kept, extra, more)| {
            let rows = kept + extra + more;
            (
                prop::collection::vec(-1.0..1.0_f64, rows * kept),
                prop::collection::vec(-2.0..2.0_f64, kept * extra),
                Just((kept, extra, rows)),
                Just((0..kept + extra).collect::<Vec<usize>>()).prop_shuffle(),
            )
        })
        .prop_map(|(entries, coefficients, (kept, extra, rows), places)| {
            let mut matrix = Matrix::zeros(rows, kept + extra);
            for row in 0..rows {
                for column in 0..kept {
                    matrix[(row, places[column])] = entries[row * kept + column];
                }
                for column in 0..extra {
                    matrix[(row, places[kept + column])] = (0..kept)
                        .map(|k| coefficients[column * kept + k] * entries[row * kept + k])
                        .sum();
                }
            }
            matrix
        })
        // Smallest remainder far from the tolerance, so that rounding cannot move a verdict.
        .prop_filter("clear gap", |matrix| {
            let order: Vec<usize> = (0..matrix.columns()).collect();
            let answer = judge(matrix, &vec![1.0; matrix.columns()], &order);
            answer.gap[0] > 1e-3
        })
}

fn kinds(statuses: &[Status]) -> Vec<u8> {
    statuses
        .iter()
        .map(|status| match status {
            Status::Identifiable { .. } => 0,
            Status::Weak { .. } => 1,
            Status::Invisible => 2,
            Status::Dependent { .. } => 3,
        })
        .collect()
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn verdicts_do_not_depend_on_units(
        matrix in planted(),
        exponents in prop::collection::vec(-9.0..9.0_f64, 8),
    ) {
        let count = matrix.columns();
        let order: Vec<usize> = (0..count).collect();
        let reference = judge(&matrix, &vec![1.0; count], &order);
        // A unit u times larger: numbers u times smaller, derivatives u times larger.
        let units: Vec<f64> = exponents[..count].iter().map(|e| 10.0_f64.powf(*e)).collect();
        let sizes: Vec<f64> = units.iter().map(|u| 1.0 / u).collect();
        let scaled = Matrix::from_fn(matrix.rows(), count, |r, c| matrix[(r, c)] * units[c]);
        let answer = judge(&scaled, &sizes, &order);
        prop_assert_eq!(kinds(&answer.statuses), kinds(&reference.statuses));
        prop_assert_eq!(answer.independent, reference.independent);
        let (a, b) = (answer.observability.unwrap(), reference.observability.unwrap());
        prop_assert!((a.o1 / b.o1 - 1.0).abs() < 1e-9 && (a.o4 / b.o4 - 1.0).abs() < 1e-9);
        for (column, (status, other)) in answer.statuses.iter().zip(&reference.statuses).enumerate() {
            if let (
                Status::Identifiable { standard_deviation: a },
                Status::Identifiable { standard_deviation: b },
            ) = (status, other) {
                prop_assert!((a * units[column] / b - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn verdicts_do_not_depend_on_rows(matrix in planted(), seed in 1..1000_usize) {
        let (rows, count) = (matrix.rows(), matrix.columns());
        let order: Vec<usize> = (0..count).rev().collect();
        let reference = judge(&matrix, &vec![1.0; count], &order);
        let turned = Matrix::from_fn(rows, count, |r, c| matrix[((r + seed) % rows, c)]);
        let v: Vec<f64> = (0..rows).map(|r| (1.0 + (r * seed) as f64).sin()).collect();
        let length: f64 = v.iter().map(|x| x * x).sum();
        let mut mixed = matrix.clone();
        for column in 0..count {
            let share: f64 = v.iter().zip(matrix.column(column)).map(|(a, b)| a * b).sum();
            for (entry, x) in mixed.column_mut(column).iter_mut().zip(&v) {
                *entry -= 2.0 * share * x / length;
            }
        }
        for other in [turned, mixed] {
            let answer = judge(&other, &vec![1.0; count], &order);
            prop_assert_eq!(kinds(&answer.statuses), kinds(&reference.statuses));
            prop_assert_eq!(&answer.independent, &reference.independent);
        }
    }

    #[test]
    fn dropping_a_dependent_parameter_keeps_the_best_prediction(
        matrix in planted(),
        rhs in prop::collection::vec(-1.0..1.0_f64, 27),
    ) {
        let count = matrix.columns();
        let order: Vec<usize> = (0..count).collect();
        let answer = judge(&matrix, &vec![1.0; count], &order);
        let rhs = &rhs[..matrix.rows()];
        let reduction = haptical_identification::Reduction::new(&matrix, rhs).unwrap();
        let all = reduction.solve(&order, 0.0, 1e-9).unwrap();
        let kept = reduction.solve(&answer.independent, 0.0, 1e-9).unwrap();
        prop_assert_eq!(all.rank, answer.rank);
        let mut values = vec![0.0; count];
        for (&index, value) in answer.independent.iter().zip(&kept.values) {
            values[index] = *value;
        }
        let with = matrix.times(&all.values).unwrap();
        let without = matrix.times(&values).unwrap();
        for (a, b) in with.iter().zip(&without) {
            prop_assert!((a - b).abs() < 1e-9);
        }
    }

    #[test]
    fn more_rows_never_raise_a_variance(
        matrix in planted(),
        extra in prop::collection::vec(-1.0..1.0_f64, 8 * 5),
    ) {
        let (rows, count) = (matrix.rows(), matrix.columns());
        let order: Vec<usize> = (0..count).collect();
        let kept = judge(&matrix, &vec![1.0; count], &order).independent;
        let longer = Matrix::from_fn(rows + 5, count, |r, c| {
            if r < rows { matrix[(r, c)] } else { extra[(r - rows) * 8 + c] }
        });
        let before = reduce(&matrix).covariance(&kept, 1e-9).unwrap();
        let after = reduce(&longer).covariance(&kept, 1e-9).unwrap();
        for k in 0..kept.len() {
            prop_assert!(after[(k, k)] <= before[(k, k)] * (1.0 + 1e-9));
        }
    }
}
