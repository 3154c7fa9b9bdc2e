//! Habits of faer 0.24 that would give wrong answers, each with the guard that meets it.

use faer::linalg::solvers::SolveLstsq;
use haptical_linalg::{LinalgError, Matrix, RANK_TOLERANCE, Reduction};

use crate::support::{all_columns, dense};

/// 300 x 12 with smooth columns; column 7 depends on 1 and 4, column 9 is zero.
fn regressor() -> Matrix {
    let wave = |row: usize, column: usize| ((row + 1) as f64 * 0.37 * (column + 1) as f64).sin();
    Matrix::from_fn(300, 12, |row, column| match column {
        7 => 2.0 * wave(row, 1) - 0.5 * wave(row, 4),
        9 => 0.0,
        _ => wave(row, column),
    })
}

fn as_faer(matrix: &Matrix) -> faer::Mat<f64> {
    faer::Mat::from_fn(matrix.rows(), matrix.columns(), |r, c| matrix[(r, c)])
}

/// Trap: the un-pivoted QR is rank-revealing, its R a staircase, so that "R_kk is nearly 0" blames
/// columns that are in order. Guard: orthogonalisation column by column, as nalgebra's QR reads.
#[test]
fn dependent_columns_are_those_of_the_textbook_rule() {
    let matrix = regressor();
    let blamed = |diagonal: &dyn Fn(usize) -> f64| -> Vec<usize> {
        (0..12).filter(|&k| diagonal(k).abs() < 1e-9).collect()
    };
    let textbook = dense(&matrix).qr().r();
    assert_eq!(blamed(&|k| textbook[(k, k)]), [7, 9]);
    #[expect(clippy::disallowed_methods, reason = "shows why it is disallowed")]
    let staircase = as_faer(&matrix).qr();
    let staircase = staircase.thin_R();
    assert_ne!(
        blamed(&|k| staircase[(k, k)]),
        [7, 9],
        "the trap is gone: simplify"
    );

    let reduction = Reduction::new(&matrix, &[0.0; 300]).unwrap();
    let rank = reduction
        .ordered_rank(&all_columns(&matrix), RANK_TOLERANCE)
        .unwrap();
    assert_eq!(rank.independent, [0, 1, 2, 3, 4, 5, 6, 8, 10, 11]);
    assert_eq!(rank.zero, [9]);
    assert_eq!(rank.dependent.len(), 1);
    let found = &rank.dependent[0];
    assert_eq!(found.column, 7);
    assert_eq!(found.combination.len(), 2);
    for ((column, value), (wanted, coefficient)) in
        found.combination.iter().zip([(1, 2.0), (4, -0.5)])
    {
        assert_eq!(*column, wanted);
        assert!((value - coefficient).abs() < 1e-12);
    }
}

/// Trap: pivoting drops whichever member of a dependent set comes last by size. Guard: the caller's
/// order decides.
#[test]
fn the_order_of_preference_decides_which_column_is_dropped() {
    let reduction = Reduction::new(&regressor(), &[0.0; 300]).unwrap();
    for dropped in [1, 4, 7] {
        let mut order: Vec<usize> = (0..12).filter(|&column| column != dropped).collect();
        order.push(dropped);
        let rank = reduction.ordered_rank(&order, RANK_TOLERANCE).unwrap();
        assert_eq!(rank.dependent.len(), 1);
        assert_eq!(rank.dependent[0].column, dropped);
    }
}

/// Trap: the pivoted QR's solution of a deficient system is NaN. Guard: the solution is cut at the
/// rank and the rank is said.
#[test]
fn a_deficient_system_is_solved_within_its_rank() {
    let matrix = regressor();
    // 3 column 7 + column 0, which columns 0, 1 and 4 can make without column 7.
    let rhs: Vec<f64> = (0..300)
        .map(|row| 3.0 * matrix[(row, 7)] + matrix[(row, 0)])
        .collect();
    let column = faer::Mat::from_fn(300, 1, |row, _| rhs[row]);
    let trap = as_faer(&matrix).col_piv_qr().solve_lstsq(&column);
    let wrong = (0..12).any(|k| !trap[(k, 0)].is_finite());
    assert!(wrong, "the trap is gone: simplify");

    let reduction = Reduction::new(&matrix, &rhs).unwrap();
    let columns = all_columns(&matrix);
    let solution = reduction.solve(&columns, 0.0, RANK_TOLERANCE).unwrap();
    assert_eq!(solution.rank, 10);
    assert!(solution.residual_square < 1e-20);
    let fitted = matrix.times(&solution.values).unwrap();
    for (fit, value) in fitted.iter().zip(&rhs) {
        assert!((fit - value).abs() < 1e-10);
    }
    let kept = [0, 1, 2, 3, 4, 5, 6, 8, 10, 11];
    let solution = reduction.solve(&kept, 0.0, RANK_TOLERANCE).unwrap();
    for (column, value) in kept.iter().zip(&solution.values) {
        let wanted = match column {
            0 => 1.0,
            1 => 6.0,
            4 => -1.5,
            _ => 0.0,
        };
        assert!((value - wanted).abs() < 1e-11);
    }
}

/// Trap: an all-zero matrix comes back as NaN. Guard: it is caught before.
#[test]
fn an_all_zero_matrix_is_not_decomposed() {
    let trap = faer::Mat::<f64>::zeros(4, 2).col_piv_qr();
    assert!(trap.thin_R()[(0, 0)].is_nan(), "the trap is gone: simplify");
    let reduction = Reduction::new(&Matrix::zeros(4, 2), &[1.0; 4]).unwrap();
    let factor = reduction.scaled_factor(&[0, 1], &[1.0, 1.0]).unwrap();
    assert_eq!(factor, Matrix::zeros(2, 2));
}

/// Trap: NaN is not refused but comes out in R. Guard: it is refused with its place.
#[test]
fn nan_is_refused_with_its_place() {
    let mut matrix = regressor();
    matrix[(17, 3)] = f64::NAN;
    assert!(matches!(
        Reduction::new(&matrix, &[0.0; 300]),
        Err(LinalgError::NotFinite {
            row: 17,
            column: 3,
            ..
        })
    ));
}

/// Trap: below the noise the pivoted diagonal is not monotone, so counting entries above a tolerance
/// can miscount. Guard: the rank is the first index below the tolerance.
#[test]
fn rank_of_a_signal_in_noise() {
    const SIGNAL: usize = 15;
    const NOISE: f64 = 1e-9;
    for trial in 0..20 {
        // Deterministic, irregular numbers in -1..1.
        let number = |a: usize, b: usize| {
            let x = ((a * 7919 + b * 104_729 + trial * 1_299_709 + 1) as f64).sin() * 43_758.545;
            2.0 * x.fract().abs() - 1.0
        };
        let matrix = Matrix::from_fn(100, 30, |row, column| {
            let signal: f64 = (0..SIGNAL)
                .map(|k| number(row, k) * number(column + 500, k + 50))
                .sum();
            signal + NOISE * number(row + 1000, column + 1000)
        });
        let reduction = Reduction::new(&matrix, &[1.0; 100]).unwrap();
        let columns = all_columns(&matrix);
        let solution = reduction.solve(&columns, 0.0, 1e-6).unwrap();
        assert_eq!(solution.rank, SIGNAL);
        let (values, _) = reduction.singular_values(&columns).unwrap();
        assert!(values[SIGNAL - 1] / values[0] > 1e-4 && values[SIGNAL] / values[0] < 1e-7);
    }
}
