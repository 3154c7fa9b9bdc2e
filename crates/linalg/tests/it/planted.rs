//! Columns planted as exact combinations of others must be found, with their coefficients.

use haptical_linalg::{Matrix, OrderedRank, RANK_TOLERANCE, Reduction};
use proptest::prelude::*;

use crate::support::{condition, matrix};

/// Coefficients come from a triangle of condition below 1e3, rounding 1e-16.
const COEFFICIENT_TOLERANCE: f64 = 1e-9;
const WORST_CONDITION: f64 = 1e3;

/// `base.columns()` independent columns and several combinations of them, every column in its own
/// unit and all in a random order.
#[derive(Debug, Clone)]
struct Planted {
    matrix: Matrix,
    /// Places of the independent columns, in order.
    kept: Vec<usize>,
    /// Places of the combinations, with one coefficient per independent column.
    planted: Vec<(usize, Vec<f64>)>,
}

impl Planted {
    fn order(&self) -> Vec<usize> {
        let planted = self.planted.iter().map(|(place, _)| *place);
        self.kept.iter().copied().chain(planted).collect()
    }
}

fn planted() -> impl Strategy<Value = Planted> {
    (1..6_usize, 1..5_usize, 2..30_usize)
        .prop_flat_map(|(kept, extra, more)| {
            let count = kept + extra;
            (
                matrix(count + more, kept),
                prop::collection::vec(
                    prop::collection::vec((0.2..2.0_f64, any::<bool>()), kept),
                    extra,
                ),
                prop::collection::vec(-12.0..12.0_f64, count),
                Just((0..count).collect::<Vec<usize>>()).prop_shuffle(),
            )
        })
        .prop_filter("independent base", |(base, ..)| {
            condition(base) < WORST_CONDITION
        })
        .prop_map(|(base, combinations, exponents, places)| {
            let kept_count = base.columns();
            let units: Vec<f64> = exponents.iter().map(|e| 10.0_f64.powf(*e)).collect();
            let mut full = Matrix::zeros(base.rows(), places.len());
            for column in 0..kept_count {
                let place = places[column];
                for row in 0..base.rows() {
                    full[(row, place)] = base[(row, column)] * units[place];
                }
            }
            let mut planted = Vec::new();
            for (index, combination) in combinations.iter().enumerate() {
                let place = places[kept_count + index];
                let signed: Vec<f64> = combination
                    .iter()
                    .map(|(size, negative)| if *negative { -size } else { *size })
                    .collect();
                let values = base.times(&signed).unwrap();
                for (row, value) in values.iter().enumerate() {
                    full[(row, place)] = value * units[place];
                }
                // column = sum of c_j base_j * unit = sum of (c_j unit / unit_j) * column_j
                let coefficients = (0..kept_count)
                    .map(|j| signed[j] * units[place] / units[places[j]])
                    .collect();
                planted.push((place, coefficients));
            }
            Planted {
                matrix: full,
                kept: places[..kept_count].to_vec(),
                planted,
            }
        })
}

fn ordered(matrix: &Matrix, order: &[usize]) -> OrderedRank {
    let reduction = Reduction::new(matrix, &vec![0.0; matrix.rows()]).unwrap();
    reduction.ordered_rank(order, RANK_TOLERANCE).unwrap()
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn exactly_the_planted_columns_are_found(case in planted()) {
        let rank = ordered(&case.matrix, &case.order());
        prop_assert_eq!(&rank.independent, &case.kept);
        prop_assert!(rank.zero.is_empty());
        let found: Vec<usize> = rank.dependent.iter().map(|d| d.column).collect();
        let places: Vec<usize> = case.planted.iter().map(|(place, _)| *place).collect();
        prop_assert_eq!(found, places);
        prop_assert!(rank.smallest_kept > 1e-4 && rank.largest_dropped < 1e-12);
        for (dependence, (_, coefficients)) in rank.dependent.iter().zip(&case.planted) {
            prop_assert_eq!(dependence.combination.len(), case.kept.len());
            for ((column, value), (kept, wanted)) in
                dependence.combination.iter().zip(case.kept.iter().zip(coefficients))
            {
                prop_assert_eq!(column, kept);
                prop_assert!((value - wanted).abs() < COEFFICIENT_TOLERANCE * wanted.abs());
            }
        }
    }

    #[test]
    fn rank_of_the_solution_is_the_planted_rank(case in planted()) {
        let reduction = Reduction::new(&case.matrix, &vec![1.0; case.matrix.rows()]).unwrap();
        let solution = reduction.solve(&case.order(), 0.0, RANK_TOLERANCE).unwrap();
        prop_assert_eq!(solution.rank, case.kept.len());
        let kept = reduction.solve(&case.kept, 0.0, RANK_TOLERANCE).unwrap();
        // The dependent columns add nothing to what can be fitted.
        prop_assert!((solution.residual_square - kept.residual_square).abs() < 1e-9);
        prop_assert!(reduction.covariance(&case.order(), RANK_TOLERANCE).is_err());
        prop_assert!(reduction.covariance(&case.kept, RANK_TOLERANCE).is_ok());
    }

    #[test]
    fn the_kept_set_does_not_depend_on_rows_or_units(
        case in planted(),
        seed in 0..1000_usize,
        exponents in prop::collection::vec(-6.0..6.0_f64, 10),
    ) {
        let (rows, columns) = (case.matrix.rows(), case.matrix.columns());
        let order: Vec<usize> = (0..columns).collect();
        let reference = ordered(&case.matrix, &order);

        // A cyclic shift with a step that shares no factor with 1: every row moves.
        let permuted = Matrix::from_fn(rows, columns, |r, c| case.matrix[((r + 1 + seed) % rows, c)]);
        prop_assert_eq!(&ordered(&permuted, &order).independent, &reference.independent);

        let scaled = Matrix::from_fn(rows, columns, |r, c| {
            case.matrix[(r, c)] * 10.0_f64.powf(exponents[c])
        });
        prop_assert_eq!(&ordered(&scaled, &order).independent, &reference.independent);

        // Reflection I - 2 v v' with a unit v: an orthogonal mixture of all rows.
        let v: Vec<f64> = (0..rows).map(|r| (1.0 + (r * (seed + 1)) as f64).sin()).collect();
        let length: f64 = v.iter().map(|x| x * x).sum::<f64>();
        let mut mixed = case.matrix.clone();
        for column in 0..columns {
            let share: f64 = v.iter().zip(case.matrix.column(column)).map(|(a, b)| a * b).sum();
            for (entry, x) in mixed.column_mut(column).iter_mut().zip(&v) {
                *entry -= 2.0 * share * x / length;
            }
        }
        prop_assert_eq!(&ordered(&mixed, &order).independent, &reference.independent);
    }
}

#[test]
fn a_combination_leaves_out_columns_that_play_no_part() {
    // Column 3 = 2 column 0 - column 2; column 1 is not involved.
    let t = [0.3, -1.2, 2.0, 0.7, 1.9];
    let matrix = Matrix::from_fn(5, 4, |row, column| {
        [1.0, t[row], t[row] * t[row], 2.0 - t[row] * t[row]][column]
    });
    let rank = ordered(&matrix, &[0, 1, 2, 3]);
    let combination = &rank.dependent[0].combination;
    assert_eq!(combination.len(), 2);
    assert_eq!((combination[0].0, combination[1].0), (0, 2));
    assert!((combination[0].1 - 2.0).abs() < COEFFICIENT_TOLERANCE);
    assert!((combination[1].1 + 1.0).abs() < COEFFICIENT_TOLERANCE);
    // First come, first kept: in the other order column 0 is the combination.
    let rank = ordered(&matrix, &[3, 2, 1, 0]);
    assert_eq!(rank.independent, [3, 2, 1]);
    assert_eq!(rank.dependent[0].column, 0);
}
