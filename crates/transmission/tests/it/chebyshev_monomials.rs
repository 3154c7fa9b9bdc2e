//! Conversion between Chebyshev series and powers: 60-digit numbers, round trips, conditioning.

use crate::fixture::{assert_close, from_monomials, rows};
use haptical_transmission::LawError;
use haptical_transmission::chebyshev::{evaluate, to_monomials};
use proptest::prelude::*;

/// Agreement asked of the two forms for degrees 4 to 14 on ranges that contain 0 well inside.
const AGREEMENT: f64 = 1e-10;

fn horner(powers: &[f64], theta_rad: f64) -> f64 {
    powers
        .iter()
        .rev()
        .fold(0.0, |sum, power| sum * theta_rad + power)
}

fn powers(range_rad: [f64; 2], coefficients: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; coefficients.len()];
    to_monomials(range_rad, coefficients, &mut out).unwrap();
    out
}

#[test]
fn agrees_with_sixty_digit_powers() {
    for row in rows(include_str!("../fixtures/chebyshev.csv")) {
        let n = (row.len() - 5) / 2;
        let (range_rad, coefficients, want) = ([row[0], row[1]], &row[5..5 + n], &row[5 + n..]);
        let got = powers(range_rad, coefficients);
        // Rounding relative to the largest power, which the cancelling sums pass through.
        let largest = want.iter().fold(0.0f64, |m, w| m.max(w.abs()));
        for (k, (g, w)) in got.iter().zip(want).enumerate() {
            assert_close(
                *g,
                *w,
                1e-13 * largest,
                &format!("k_{k} of degree {}", n - 1),
            );
        }
        let back = from_monomials(range_rad, want);
        for (k, (g, w)) in back.iter().zip(coefficients).enumerate() {
            assert_close(*g, *w, AGREEMENT, &format!("c_{k} of degree {}", n - 1));
        }
    }
}

#[test]
fn shifted_range_by_hand() {
    // x = theta - 1 on [0, 2]; T_2 = 2 x^2 - 1 = 2 theta^2 - 4 theta + 1
    assert_eq!(powers([0.0, 2.0], &[0.0, 0.0, 1.0]), [1.0, -4.0, 2.0]);
    assert_eq!(
        from_monomials([0.0, 2.0], &[1.0, -4.0, 2.0]),
        [0.0, 0.0, 1.0]
    );
    assert_eq!(powers([0.0, 2.0], &[3.0, 5.0]), [-2.0, 5.0]);
    assert_eq!(powers([0.0, 2.0], &[3.0]), [3.0]);
    assert_eq!(powers([0.0, 2.0], &[]), [] as [f64; 0]);
}

#[test]
fn degree_ten_has_the_known_amplification() {
    let mut tenth = [0.0; 11];
    tenth[10] = 1.0;
    let total = |range_rad| {
        powers(range_rad, &tenth)
            .iter()
            .map(|k| k.abs())
            .sum::<f64>()
    };
    // The sizes of the powers of T_10 add up to |T_10(i)| on [-1, 1] and to T_10(3) on [0, 1].
    assert_eq!(total([-1.0, 1.0]), 3363.0);
    assert_eq!(total([0.0, 1.0]), 22_619_537.0);
    // The way back amplifies nothing: x^10 = 2^-10 [C(10, 5) T_0 + 2 C(10, 4) T_2 + ...].
    let back = from_monomials([-1.0, 1.0], &tenth);
    let want = [
        252.0, 0.0, 420.0, 0.0, 240.0, 0.0, 90.0, 0.0, 20.0, 0.0, 2.0,
    ];
    for (k, (got, want)) in back.iter().zip(want).enumerate() {
        assert_eq!(*got, want / 1024.0, "c_{k}");
    }
}

#[test]
fn degree_ten_round_trip_loses_no_more_than_its_amplification() {
    let coefficients: Vec<f64> = (0..11)
        .map(|k| 0.01 / f64::from(1 + k * k) - 0.001)
        .collect();
    for (range_rad, amplification) in [([-0.785, 0.785], 3363.0), ([0.0, 1.3], 2.3e7)] {
        let back = from_monomials(range_rad, &powers(range_rad, &coefficients));
        for (k, (got, want)) in back.iter().zip(&coefficients).enumerate() {
            let bound = 0.01 * f64::EPSILON * amplification;
            assert_close(*got, *want, bound, &format!("c_{k} on {range_rad:?}"));
        }
    }
}

#[test]
fn bad_arguments_are_refused() {
    let mut three = [0.0; 3];
    let mut two = [0.0; 2];
    assert_eq!(
        to_monomials([-1.0, 1.0], &[0.0; 3], &mut two),
        Err(LawError::LengthMismatch {
            quantity: "output slice",
            got: 2,
            expected: 3
        })
    );
    assert_eq!(
        to_monomials([1.0, -1.0], &[0.0; 3], &mut three),
        Err(LawError::InvalidRange {
            quantity: "range",
            lower_rad: 1.0,
            upper_rad: -1.0
        })
    );
    let not_finite = [0.0, f64::INFINITY, 0.0];
    assert!(to_monomials([-1.0, 1.0], &not_finite, &mut three).is_err());
    // powers of 1e200 overflow
    assert!(to_monomials([-1e-200, 1e-200], &[1.0; 3], &mut three).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn both_forms_agree_and_round_trip(
        degree in 4usize..=14,
        half in 0.3..1.5f64,
        shift in -0.2..0.2f64,
        draws in prop::array::uniform15(-0.05..0.05f64),
    ) {
        let range_rad = [half * (shift - 1.0), half * (shift + 1.0)];
        let coefficients = &draws[..=degree];
        let monomials = powers(range_rad, coefficients);
        for step in 0..=20 {
            let theta_rad = range_rad[0] + 2.0 * half * f64::from(step) / 20.0;
            let (value_rad, _) = evaluate(range_rad, coefficients, theta_rad);
            let gap = (value_rad - horner(&monomials, theta_rad)).abs();
            prop_assert!(gap < AGREEMENT, "degree {degree} at {theta_rad}: {gap}");
        }
        for (got, want) in from_monomials(range_rad, &monomials).iter().zip(coefficients) {
            prop_assert!((got - want).abs() < AGREEMENT);
        }
    }
}
