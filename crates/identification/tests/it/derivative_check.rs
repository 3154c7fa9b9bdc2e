//! The derivative check finds what is wrong and refuses what it cannot judge.

use haptical_identification::{IdentificationError, evaluate_jacobian, worst_derivative};

use crate::support::{Closure, decay};

const T: [f64; 4] = [0.0, 0.5, 1.0, 2.0];

#[test]
fn right_derivatives_pass() {
    let problem = decay(&T, &[1.0; 4], 0.1);
    let worst = worst_derivative(&problem, &[2.0, 0.7, 0.3], 1e-5).unwrap();
    // Truncation 1e-10, rounding 1e-11.
    assert!(worst.relative < 1e-9, "{worst:?}");
}

#[test]
fn a_flipped_sign_is_found_with_its_place() {
    let right = decay(&T, &[1.0; 4], 0.1);
    let wrong = Closure {
        parameters: 3,
        rows: 4,
        evaluate: |p: &[f64]| {
            let (values, mut slopes) = (right.evaluate)(p)?;
            slopes[2][1] = -slopes[2][1];
            Ok((values, slopes))
        },
    };
    let worst = worst_derivative(&wrong, &[2.0, 0.7, 0.3], 1e-5).unwrap();
    assert_eq!((worst.row, worst.parameter), (2, 1));
    assert!((worst.analytic + worst.numeric).abs() < 1e-6 * worst.analytic.abs());
    assert!(worst.relative > 0.5);
}

#[test]
fn a_derivative_that_is_not_a_number_is_an_error() {
    let broken = Closure {
        parameters: 2,
        rows: 1,
        evaluate: |p: &[f64]| Ok((vec![p[0] + p[1]], vec![vec![1.0, f64::NAN]])),
    };
    for refused in [
        worst_derivative(&broken, &[1.0, 1.0], 1e-5).map(|_| ()),
        evaluate_jacobian(&broken, &[1.0, 1.0], &[1]).map(|_| ()),
    ] {
        assert!(matches!(
            refused,
            Err(IdentificationError::NotFinite {
                row: 0,
                column: 1,
                ..
            })
        ));
    }
    let problem = decay(&T, &[1.0; 4], 0.1);
    for step in [0.0, -1e-6, f64::NAN] {
        assert!(matches!(
            worst_derivative(&problem, &[1.0; 3], step),
            Err(IdentificationError::Setting { name: "step", .. })
        ));
    }
}
