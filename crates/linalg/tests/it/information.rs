//! What the rows of a fit say of other rows.

use haptical_linalg::Information;

/// Two columns that the fit's rows do not tell apart: their sum is known, their difference is not.
#[test]
fn what_the_rows_do_not_tell_apart_is_not_predicted() {
    let two = Information::new(2, |_, _| 100.0);
    assert!((two.leverage(|_| 1.0) - 0.01).abs() < 1e-12);
    assert!(!two.determines(|column| [1.0, -1.0][column]));
    assert!(!two.determines(|column| [1.0, 0.0][column]));
    // knowing one of them does
    let known = Information::new(2, |a, b| if a == 1 && b == 1 { 110.0 } else { 100.0 });
    assert!((known.leverage(|column| [1.0, 0.0][column]) - 0.11).abs() < 1e-9);
}

/// What rounding leaves of a column that was zero is no information on it.
#[test]
fn a_column_of_rounding_is_not_predicted() {
    let rounding = Information::new(2, |a, b| match (a, b) {
        (0, 0) => 50.0,
        (1, 1) => 1e-30,
        _ => 0.0,
    });
    assert!(!rounding.determines(|column| [1.0, 0.3][column]));
    assert!(rounding.determines(|column| [1.0, 0.0][column]));
}
