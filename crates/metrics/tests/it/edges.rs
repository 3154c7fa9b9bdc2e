//! The limits of each metric: the last argument served, the first refused, and why.

use haptical_metrics::{
    MetricsError, best_rotation, binomial_two_sided_p, correlation, gap_reduction_percent,
    holm_adjusted, orientation_angle_rad, rms_improvement_percent, spearman, student_t_quantile,
    wilson_interval,
};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn degrees_of_freedom_that_are_none_are_named() {
    let refused = student_t_quantile(0.95, 0.0).unwrap_err();
    let expected = MetricsError::OutOfRange {
        what: "degrees of freedom",
        got: 0.0,
        allowed: "greater than 0",
    };
    assert_eq!(refused, expected);
    assert!(student_t_quantile(0.95, f64::NAN).is_err());
}

#[test]
fn wilson_ends_at_no_and_at_all_successes_are_exact() {
    for n in 1..40 {
        let none = wilson_interval(0, n, 0.9).unwrap();
        let all = wilson_interval(n, n, 0.9).unwrap();
        assert_eq!((none.low, all.high), (0.0, 1.0));
        // Wilson's upper end without a success: z^2 / (n + z^2)
        let z2 = 1.644_853_626_951_472_7_f64.powi(2);
        let end = z2 / (n as f64 + z2);
        assert!((none.high - end).abs() < 1e-12 && (all.low - (1.0 - end)).abs() < 1e-12);
    }
}

#[test]
fn rms_improvement_at_zero() {
    assert_eq!(
        rms_improvement_percent(2.0, 0.0)
            .unwrap()
            .percent_as_printed,
        100.0
    );
    for (before, after, named) in [
        (0.0, 1.0, "before_rms"),
        (-1.0, 1.0, "before_rms"),
        (1.0, -1e-9, "after_rms"),
    ] {
        let refused = rms_improvement_percent(before, after).unwrap_err();
        assert!(
            matches!(refused, MetricsError::OutOfRange { what, .. } if what == named),
            "{refused}"
        );
    }
    assert_eq!(gap_reduction_percent(2.0, 0.0, 0.0), Some(100.0));
    assert_eq!(gap_reduction_percent(2.0, f64::INFINITY, 0.0), None);
}

#[test]
fn probabilities_at_their_ends_are_served() {
    assert_eq!(holm_adjusted(&[0.0, 1.0]).unwrap(), [0.0, 1.0]);
    assert!((binomial_two_sided_p(7, 7, 0.5).unwrap() - 2.0 / 128.0).abs() < 1e-12);
}

#[test]
fn correlations_hold_at_the_ends_of_the_number_range() {
    for scale in [1e-300, 1.0, 1e307] {
        let x = [scale, 2.0 * scale, 3.0 * scale, 4.0 * scale];
        let y = [0.0, 2.0 * scale, 0.0, 2.0 * scale];
        let r = correlation(&x, &y).unwrap();
        assert!((r - 2.0 / 20.0_f64.sqrt()).abs() < 1e-13, "{scale}: {r}");
    }
    for function in [correlation, spearman] {
        let pair = function(&[1.0, 2.0], &[5.0, 3.0]).unwrap();
        assert!((pair + 1.0).abs() < 1e-14, "{pair}");
        let single = function(&[1.0], &[1.0]).unwrap_err();
        assert_eq!(
            single,
            MetricsError::TooFew {
                what: "x",
                got: 1,
                needed: 2
            }
        );
        let constant = function(&[1.0, 2.0], &[4.0, 4.0]).unwrap_err();
        assert_eq!(
            constant,
            MetricsError::ConstantSeries {
                what: "y",
                value: 4.0
            }
        );
    }
}

/// With ties at the start, in the middle and at the end: Spearman's of hand-written mean ranks.
#[test]
fn ranks_of_ties_are_their_mean() {
    let x = [3.0, 3.0, 1.0, 1.0, 1.0, 2.0, 7.0, 7.0];
    let ranks = [5.5, 5.5, 2.0, 2.0, 2.0, 4.0, 7.5, 7.5];
    let y = [0.3, -1.0, 4.0, 2.0, 9.0, 5.0, 8.0, -3.0];
    let ranks_of_y = [3.0, 2.0, 5.0, 4.0, 8.0, 6.0, 7.0, 1.0];
    let found = spearman(&x, &y).unwrap();
    let expected = correlation(&ranks, &ranks_of_y).unwrap();
    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
}

#[test]
fn what_is_no_rotation_says_by_how_much() {
    let deviation = |matrix: [[f64; 3]; 3]| match orientation_angle_rad(&IDENTITY, &matrix) {
        Err(MetricsError::NotARotation { deviation, .. }) => deviation,
        other => panic!("{other:?}"),
    };
    let diagonal = |x: f64, y: f64, z: f64| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
    assert_eq!(deviation(diagonal(1.0, 1.0, -1.0)), 2.0);
    assert_eq!(deviation(diagonal(2.0, 1.0, 1.0)), 3.0);
    assert_eq!(deviation(diagonal(2.0, 1.0, -1.0)), 3.0);
    let slightly = deviation(diagonal(1.0, 1.0 + 1e-6, 1.0));
    assert!((slightly - 2e-6).abs() < 1e-11, "{slightly}");
    assert!(orientation_angle_rad(&IDENTITY, &diagonal(1.0, 1.0 + 4e-7, 1.0)).is_ok());
}

#[test]
fn the_best_rotation_does_not_depend_on_the_units() {
    let from = [[0.3, 0.1, -0.2], [-0.1, 0.4, 0.25], [0.2, -0.35, 0.1]];
    // a quarter turn about z
    let to = from.map(|[x, y, z]: [f64; 3]| [-y, x, z]);
    for (from_unit, to_unit) in [(1e-200, 1e200), (1e200, 1e200), (1e-200, 1e-200)] {
        let found = best_rotation(
            &from.map(|p| p.map(|v| v * from_unit)),
            &to.map(|p| p.map(|v| v * to_unit)),
        )
        .unwrap();
        let expected = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        for (row, expected) in found.iter().zip(expected) {
            for (entry, expected) in row.iter().zip(expected) {
                assert!((entry - expected).abs() < 1e-12, "{found:?}");
            }
        }
    }
}

#[test]
fn points_that_cancel_leave_the_rotation_open() {
    // the sum of the products is zero, though no point is
    let from = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
    let to = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let (separation, needed) = (0.0, 1e-10);
    let expected = MetricsError::RotationNotUnique { separation, needed };
    assert_eq!(best_rotation(&from, &to).unwrap_err(), expected);
    for (from, to) in [
        ([[0.0; 3]], [[1.0, 0.0, 0.0]]),
        ([[1.0, 0.0, 0.0]], [[0.0; 3]]),
    ] {
        assert_eq!(best_rotation(&from, &to).unwrap_err(), expected);
    }
}

/// What determines the turn about x is weighed against all points together, not against one.
#[test]
fn one_small_point_beside_many_on_a_line_leaves_the_rotation_open() {
    let line = |small: f64| {
        let mut points = vec![[1.0, 0.0, 0.0]; 1000];
        points.push([0.0, small, 0.0]);
        points
    };
    // its square over the 1000 of the line
    let points = line(5e-8_f64.sqrt());
    let Err(MetricsError::RotationNotUnique { separation, .. }) = best_rotation(&points, &points)
    else {
        panic!("the rotation was taken for determined")
    };
    assert!((separation / 5e-11 - 1.0).abs() < 1e-3, "{separation:e}");
    let points = line(2e-7_f64.sqrt());
    assert!(best_rotation(&points, &points).is_ok());
}
