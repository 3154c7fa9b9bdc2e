//! Fits from sums of products against singular value decompositions of the rows.

use haptical_linalg::{Matrix, NormalEquations};
use proptest::prelude::*;

use crate::support::{condition, dense, matrix, svd_least_squares, tall_problem};

/// Products square the condition number, which is below 100 here: half the digits are left.
const CLOSE: f64 = 1e-9;

fn columns(matrix: &Matrix) -> Vec<&[f64]> {
    (0..matrix.columns()).map(|k| matrix.column(k)).collect()
}

fn all(sums: &NormalEquations) -> Vec<usize> {
    (0..sums.columns()).collect()
}

proptest! {
    #[test]
    fn a_fit_is_that_of_least_squares((design, target) in tall_problem()) {
        prop_assume!(condition(&design) < 100.0);
        let sums = NormalEquations::from_columns(&columns(&design), &target);
        let fit = sums.solve(&all(&sums), |_| 0.0);
        let expected = svd_least_squares(&design, &target);
        for (found, expected) in fit.coefficients().iter().zip(&expected) {
            prop_assert!((found - expected).abs() < CLOSE * expected.abs().max(1.0));
        }
        let predicted = design.times(&expected).unwrap();
        let rest: f64 = predicted.iter().zip(&target).map(|(a, b)| (a - b).powi(2)).sum();
        prop_assert!((fit.rest_square() - rest).abs() < CLOSE);
        prop_assert!((sums.left(&all(&sums), fit.coefficients()) - rest).abs() < CLOSE);
        prop_assert!((fit.explained() + rest - sums.target_square()).abs() < CLOSE);
        let whole = dense(&design);
        let inverse = (whole.transpose() * whole).try_inverse().unwrap();
        let found = dense(&fit.inverse());
        prop_assert!((&found - &inverse).amax() < CLOSE * inverse.amax());
    }

    /// Rows one by one, in two parts, with a part taken off again, and a part of the columns.
    #[test]
    fn parts_add_and_subtract((design, target) in tall_problem(), cut in 0.0..1.0_f64) {
        prop_assume!(condition(&design) < 100.0);
        let count = design.columns();
        let cut = (cut * target.len() as f64) as usize;
        let mut parts = [NormalEquations::new(count), NormalEquations::new(count)];
        for row in 0..target.len() {
            let entries = (0..count).map(|k| design[(row, k)]).chain([target[row]]);
            parts[usize::from(row >= cut)].add_row(&entries.collect::<Vec<_>>());
        }
        let whole = NormalEquations::from_columns(&columns(&design), &target);
        let both = parts[0].plus(&parts[1], 1.0);
        let one = both.plus(&parts[1], -1.0);
        for a in 0..=count {
            for b in 0..=count {
                prop_assert!((both.product(a, b) - whole.product(a, b)).abs() < 1e-12);
                prop_assert!((one.product(a, b) - parts[0].product(a, b)).abs() < 1e-12);
            }
        }
        let chosen: Vec<usize> = (0..count).step_by(2).rev().collect();
        let part = Matrix::from_fn(target.len(), chosen.len(), |row, k| design[(row, chosen[k])]);
        let expected = svd_least_squares(&part, &target);
        for (found, expected) in whole.solve(&chosen, |_| 0.0).coefficients().iter().zip(&expected) {
            prop_assert!((found - expected).abs() < CLOSE * expected.abs().max(1.0));
        }
    }

    /// What columns leave of others, against projections of the rows.
    #[test]
    fn others_across_a_fit_are_projections(design in matrix(12, 5)) {
        prop_assume!(condition(&design) < 100.0);
        let own = columns(&design);
        let sums = NormalEquations::from_columns(&own[..4], own[4]);
        let across = sums.across(&sums.solve(&[2, 0], |_| 0.0), &[1, 3]);
        let taken = dense(&Matrix::from_fn(12, 2, |row, k| own[[2, 0][k]][row]));
        let q = taken.qr().q();
        let others = dense(&Matrix::from_fn(12, 2, |row, k| own[[1, 3][k]][row]));
        let left = &others - &q * (q.transpose() * &others);
        prop_assert!((dense(&across) - left.transpose() * left).amax() < CLOSE);
    }

    /// A sum of columns, and columns times a factor, against those columns written out.
    #[test]
    fn sums_and_multiples_of_columns_are_columns(design in matrix(9, 4), factors in [-2.0..2.0_f64, -2.0..2.0]) {
        let own = columns(&design);
        let sums = NormalEquations::from_columns(&own[..3], own[3]);
        let sum: Vec<f64> = (0..9).map(|row| factors[0] * own[0][row] + factors[1] * own[2][row]).collect();
        let with = sums.with_sums(&[&[(0, factors[0]), (2, factors[1])]]);
        let expected = NormalEquations::from_columns(&[own[0], own[1], own[2], &sum], own[3]);
        let scaled = sums.scaled(1..3, factors[0]);
        let times = |k: usize| -> Vec<f64> { own[k].iter().map(|value| factors[0] * value).collect() };
        let written = NormalEquations::from_columns(&[own[0], &times(1), &times(2)], own[3]);
        for a in 0..=4 {
            for b in 0..=4 {
                prop_assert!((with.product(a, b) - expected.product(a, b)).abs() < 1e-12);
                if a < 4 && b < 4 {
                    prop_assert!((scaled.product(a, b) - written.product(a, b)).abs() < 1e-12);
                }
            }
        }
    }
}

/// y = 1, 2, 3, 5 with a constant that is there twice: the second has nothing to add.
#[test]
fn a_column_that_adds_nothing_has_no_coefficient() {
    let sums = NormalEquations::from_columns(
        &[&[1.0; 4], &[3.0; 4], &[0.0, 1.0, 2.0, 3.0]],
        &[1.0, 2.0, 3.0, 5.0],
    );
    let fit = sums.solve(&[0, 1, 2], |_| 0.0);
    for (found, wanted) in fit.coefficients().iter().zip([0.8, 0.0, 1.3]) {
        assert!((found - wanted).abs() < 1e-12, "{found}");
    }
    assert!((fit.rest_square() - 0.3).abs() < 1e-12);
    assert!((fit.inverse()[(0, 0)] - 0.7).abs() < 1e-12 && fit.inverse()[(1, 1)] == 0.0);
}

/// A coefficient that is known to 0.5 beforehand: (2 + 4) b = 6.
#[test]
fn what_is_known_beforehand_pulls() {
    let sums = NormalEquations::from_columns(&[&[1.0, 1.0]], &[4.0, 2.0]);
    let fit = sums.solve(&[0], |_| 4.0);
    assert!((fit.coefficients()[0] - 1.0).abs() < 1e-12);
    assert!((fit.inverse_times(&[3.0])[0] - 0.5).abs() < 1e-12);
    // the cost 20 falls by 6
    assert!((fit.explained() - 6.0).abs() < 1e-12);
}
