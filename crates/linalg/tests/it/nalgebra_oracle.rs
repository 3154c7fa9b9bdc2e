//! Reductions of random tall matrices against nalgebra's QR and SVD.

use haptical_linalg::{RANK_TOLERANCE, Reduction, singular_values};
use proptest::prelude::*;

use crate::support::{
    all_columns, condition, dense, normalised, relative_difference, svd_least_squares, tall_problem,
};

/// Condition numbers are kept below 1e3, so rounding of 1e-16 stays below this.
const AGREEMENT: f64 = 1e-11;
const WORST_CONDITION: f64 = 1e3;

proptest! {
    #![proptest_config(crate::support::cases(64))]

    /// The remainder of column k after the columns before it is |R_kk| of an un-pivoted QR.
    #[test]
    fn ordered_remainders_are_the_diagonal_of_an_unpivoted_qr((matrix, rhs) in tall_problem()) {
        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let diagonal: Vec<f64> =
            normalised(&matrix).0.qr().r().diagonal().iter().map(|d| d.abs()).collect();
        let order = all_columns(&matrix);
        for count in 1..=order.len() {
            let rank = reduction.ordered_rank(&order[..count], RANK_TOLERANCE).unwrap();
            let smallest = diagonal[..count].iter().copied().fold(f64::INFINITY, f64::min);
            prop_assert!((rank.smallest_kept - smallest).abs() < AGREEMENT);
            prop_assert_eq!(rank.independent.len(), count);
        }
    }

    #[test]
    fn singular_values_agree((matrix, rhs) in tall_problem()) {
        let sorted = |mut values: Vec<f64>| { values.sort_by(|a, b| b.total_cmp(a)); values };
        let unscaled = sorted(dense(&matrix).singular_values().iter().copied().collect());
        let ours = singular_values(&matrix).unwrap();
        prop_assert!(relative_difference(&ours, &unscaled) < AGREEMENT);

        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let (values, vectors) = reduction.singular_values(&all_columns(&matrix)).unwrap();
        let (scaled, _) = normalised(&matrix);
        let reference = sorted(scaled.singular_values().iter().copied().collect());
        prop_assert!(relative_difference(&values, &reference) < AGREEMENT);
        // A right singular vector is stretched by its singular value.
        for (k, value) in values.iter().enumerate() {
            let stretched = &scaled * nalgebra::DVector::from_column_slice(vectors.column(k));
            prop_assert!((stretched.norm() - value).abs() < AGREEMENT);
        }
    }

    #[test]
    fn least_squares_agrees((matrix, rhs) in tall_problem(), skipped in 0..7_usize) {
        prop_assume!(condition(&matrix) < WORST_CONDITION);
        let reduction = Reduction::new(&matrix, &rhs).unwrap();
        let solution = reduction.solve(&all_columns(&matrix), 0.0, 1e-12).unwrap();
        let reference = svd_least_squares(&matrix, &rhs);
        prop_assert!(relative_difference(&solution.values, &reference) < 1e3 * AGREEMENT);
        prop_assert_eq!(solution.rank, matrix.columns());
        let fitted = matrix.times(&solution.values).unwrap();
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
        let residual = square(&mut fitted.iter().zip(&rhs).map(|(f, b)| b - f));
        let size = square(&mut rhs.iter().copied());
        prop_assert!((solution.residual_square - residual).abs() < AGREEMENT * size);
        prop_assert!((solution.explained_square - (size - residual)).abs() < AGREEMENT * size);

        // A subset of columns, in another order, from the same reduction.
        let mut subset = all_columns(&matrix);
        subset.reverse();
        if subset.len() > 1 {
            subset.remove(skipped % subset.len());
        }
        let chosen = haptical_linalg::Matrix::from_fn(matrix.rows(), subset.len(), |r, c| {
            matrix[(r, subset[c])]
        });
        let solution = reduction.solve(&subset, 0.0, 1e-12).unwrap();
        let reference = svd_least_squares(&chosen, &rhs);
        prop_assert!(relative_difference(&solution.values, &reference) < 1e3 * AGREEMENT);
    }
}
