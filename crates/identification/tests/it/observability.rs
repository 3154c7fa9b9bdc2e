//! Observability indices by hand.

use haptical_identification::{Matrix, Observability};

use crate::support::judge;

/// A handful of roundings.
const ROUNDING: f64 = 1e-14;

fn assert_indices(found: Observability, wanted: [f64; 5]) {
    let found = [found.o1, found.o2, found.o3, found.o4, found.o5];
    for (index, (found, wanted)) in found.iter().zip(wanted).enumerate() {
        assert!(
            (found - wanted).abs() < ROUNDING * wanted,
            "O{}: {found}",
            index + 1
        );
    }
}

#[test]
fn indices_of_singular_values_8_2_1_and_nine_measurements() {
    let found = Observability::from_singular_values(&[8.0, 2.0, 1.0], 9).unwrap();
    // Cube root of 16 over 3; 1/8; 1; 1/8; 1 / (1/8 + 1/2 + 1) = 8/13.
    assert_indices(
        found,
        [16.0_f64.cbrt() / 3.0, 0.125, 1.0, 0.125, 8.0 / 13.0],
    );
}

#[test]
fn columns_are_scaled_by_plausible_sizes() {
    // Orthogonal columns of norms 5 and 2; sizes 0.2 and 0.25 make the singular values 1 and 0.5.
    let matrix = Matrix::from_fn(4, 2, |row, column| {
        [[3.0, 0.0], [0.0, 2.0], [4.0, 0.0], [0.0, 0.0]][row][column]
    });
    let found = judge(&matrix, &[0.2, 0.25], &[0, 1]).observability.unwrap();
    assert_indices(found, [0.5_f64.sqrt() / 2.0, 0.5, 0.5, 0.25, 1.0 / 3.0]);
}

#[test]
fn what_is_no_list_of_singular_values_has_no_indices() {
    for values in [
        &[] as &[f64],
        &[1.0, 0.0],
        &[1.0, -1.0],
        &[1.0, 2.0],
        &[f64::NAN, 1.0],
        &[2.0, f64::NAN, 1.0],
        &[f64::INFINITY, 1.0],
    ] {
        assert_eq!(Observability::from_singular_values(values, 3), None);
    }
    assert_eq!(Observability::from_singular_values(&[1.0], 0), None);
}
