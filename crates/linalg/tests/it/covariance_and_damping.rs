//! Covariance against the inverse Gram matrix, damped steps against the augmented system.

use haptical_linalg::{LinalgError, Matrix, RANK_TOLERANCE, Reduction};
use proptest::prelude::*;

use crate::support::{
    all_columns, condition, dense, relative_difference, svd_least_squares, tall_problem,
};

/// The inverse Gram matrix itself loses the square of the condition number (below 1e2) to rounding.
const COVARIANCE_AGREEMENT: f64 = 1e-10;
const WORST_CONDITION: f64 = 1e2;
/// The augmented system is better conditioned than the plain one.
const STEP_AGREEMENT: f64 = 1e-9;

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn covariance_is_the_inverse_gram_matrix((matrix, rhs) in tall_problem()) {
        prop_assume!(condition(&matrix) < WORST_CONDITION);
        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let covariance = reduction.covariance(&all_columns(&matrix), RANK_TOLERANCE).unwrap();
        let plain = dense(&matrix);
        let inverse = (plain.transpose() * &plain).try_inverse().unwrap();
        for column in 0..matrix.columns() {
            let reference: Vec<f64> = inverse.column(column).iter().copied().collect();
            let difference = relative_difference(covariance.column(column), &reference);
            prop_assert!(difference < COVARIANCE_AGREEMENT, "{}", difference);
        }
    }

    /// Covariance of A D is D^-1 (A'A)^-1 D^-1: units must not matter, nor the order asked for.
    #[test]
    fn covariance_follows_units_and_order(
        (matrix, rhs) in tall_problem(),
        exponents in prop::collection::vec(-9.0..9.0_f64, 7),
    ) {
        prop_assume!(condition(&matrix) < WORST_CONDITION);
        let units: Vec<f64> = exponents.iter().map(|e| 10.0_f64.powf(*e)).collect();
        let scaled = Matrix::from_fn(matrix.rows(), matrix.columns(), |r, c| {
            matrix[(r, c)] * units[c]
        });
        let order = all_columns(&matrix);
        let reversed: Vec<usize> = order.iter().rev().copied().collect();
        let plain = Reduction::new(&matrix, &rhs).unwrap();
        let plain = plain.covariance(&order, RANK_TOLERANCE).unwrap();
        let other = Reduction::new(&scaled, &rhs).unwrap();
        let other = other.covariance(&reversed, RANK_TOLERANCE).unwrap();
        let last = order.len() - 1;
        for a in 0..=last {
            for b in 0..=last {
                let back = other[(last - a, last - b)] * units[a] * units[b];
                let size = (plain[(a, a)] * plain[(b, b)]).sqrt();
                prop_assert!((back - plain[(a, b)]).abs() < COVARIANCE_AGREEMENT * size);
            }
        }
    }

    #[test]
    fn damped_step_solves_the_augmented_system(
        (matrix, rhs) in tall_problem(),
        exponent in -6.0..3.0_f64,
        weights in prop::collection::vec(0.1..10.0_f64, 7),
    ) {
        prop_assume!(condition(&matrix) < 1e3);
        let damping = 10.0_f64.powf(exponent);
        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let columns = all_columns(&matrix);
        let (rows, count) = (matrix.rows(), columns.len());
        let ones = vec![1.0; count];
        for weights in [&ones[..], &weights[..count]] {
            let step = reduction.solve_weighted(&columns, damping, weights, 1e-12).unwrap();
            let augmented = Matrix::from_fn(rows + count, count, |r, c| {
                if r < rows {
                    matrix[(r, c)]
                } else if r - rows == c {
                    let norm = matrix.column(c).iter().map(|x| x * x).sum::<f64>().sqrt();
                    damping.sqrt() * weights[c] * norm
                } else {
                    0.0
                }
            });
            let mut extended = rhs.clone();
            extended.resize(rows + count, 0.0);
            let reference = svd_least_squares(&augmented, &extended);
            prop_assert!(relative_difference(&step.values, &reference) < STEP_AGREEMENT);
        }
        let plain = reduction.solve(&columns, damping, 1e-12).unwrap();
        let weighted = reduction.solve_weighted(&columns, damping, &ones, 1e-12).unwrap();
        prop_assert_eq!(plain, weighted);
    }

    /// More damping never fits better and never steps further.
    #[test]
    fn damping_shortens((matrix, rhs) in tall_problem()) {
        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let columns = all_columns(&matrix);
        let mut before = (0.0_f64, f64::INFINITY);
        for damping in [0.0, 1e-4, 1e-2, 1.0, 100.0] {
            let step = reduction.solve(&columns, damping, 1e-14).unwrap();
            let length: f64 = step.values.iter().zip(reduction.column_norms())
                .map(|(x, norm)| (x * norm).powi(2)).sum();
            prop_assert!(step.residual_square >= before.0 - 1e-12);
            prop_assert!(length <= before.1 * (1.0 + 1e-9));
            before = (step.residual_square, length);
        }
    }
}

#[test]
fn covariance_of_a_deficient_set_is_refused() {
    let matrix = Matrix::from_fn(9, 3, |row, column| {
        let t = row as f64 / 3.0;
        [1.0, t, 5.0 - 2.0 * t][column]
    });
    let reduction = Reduction::new(&matrix, &[0.0; 9]).unwrap();
    assert_eq!(
        reduction.covariance(&[0, 1, 2], RANK_TOLERANCE),
        Err(LinalgError::RankDeficient {
            rank: 2,
            columns: 3
        })
    );
    // Variance of the slope of a line: 1 / sum of (t - mean)^2 = 1 / (60 / 9).
    let line = reduction.covariance(&[0, 1], RANK_TOLERANCE).unwrap();
    assert!((line[(1, 1)] - 0.15).abs() < 1e-14);
}

#[test]
fn a_heavy_weight_leaves_the_other_columns_alone() {
    let matrix = Matrix::from_fn(6, 2, |row, column| [1.0, row as f64][column]);
    let rhs = [2.0, 2.0, 2.0, 2.0, 2.0, 2.0];
    let reduction = Reduction::new(&matrix, &rhs).unwrap();
    let step = reduction
        .solve_weighted(&[0, 1], 1e-14, &[1.0, 1e40], 1e-12)
        .unwrap();
    assert_eq!(step.rank, 2);
    assert!((step.values[0] - 2.0).abs() < 1e-12 && step.values[1].abs() < 1e-12);
}
