//! Reads the reference numbers written by `tests/fixtures/generate.py` and compares with them.

/// Rows of numbers; lines that start with `#` are skipped.
pub(crate) fn rows(text: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| {
        line.split(',')
            .map(|n| n.parse().expect("a number"))
            .collect()
    };
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(numbers)
        .collect();
    assert!(!rows.is_empty(), "the fixture has no rows");
    rows
}

/// `N` numbers of a row from `at` on.
pub(crate) fn take<const N: usize>(row: &[f64], at: usize) -> [f64; N] {
    row[at..at + N].try_into().expect("N numbers")
}

/// Asserts that two numbers differ by no more than `tolerance`.
#[track_caller]
pub(crate) fn assert_close(got: f64, want: f64, tolerance: f64, what: &str) {
    let difference = (got - want).abs();
    assert!(
        difference <= tolerance,
        "{what}: got {got:e}, want {want:e}, differ by {difference:e}"
    );
}

/// Asserts that each number equals its reference within `relative` of that reference, or of
/// `smallest` where the reference is smaller.
#[track_caller]
pub(crate) fn assert_all_close(
    got: &[f64],
    want: &[f64],
    relative: f64,
    smallest: f64,
    what: &str,
) {
    assert_eq!(got.len(), want.len(), "{what}: number of entries");
    for (index, (g, w)) in got.iter().zip(want).enumerate() {
        assert_close(
            *g,
            *w,
            relative * w.abs().max(smallest),
            &format!("{what} [{index}]"),
        );
    }
}

/// Central difference quotient.
pub(crate) fn difference_quotient(function: impl Fn(f64) -> f64, at: f64, step: f64) -> f64 {
    (function(at + step) - function(at - step)) / (2.0 * step)
}

/// Chebyshev coefficients over a range of the polynomial with the powers `powers` (Mason & Handscomb,
/// section 2.3, read backwards).
pub(crate) fn from_monomials([lower, upper]: [f64; 2], powers: &[f64]) -> Vec<f64> {
    let half_width = 0.5 * (upper - lower);
    let centre = lower + half_width;
    let mut series = powers.to_vec();
    for start in 0..series.len() {
        for k in (start + 1..series.len()).rev() {
            series[k - 1] += centre * series[k];
        }
    }
    let mut scale = 1.0;
    for power in &mut series {
        *power *= scale;
        scale *= half_width;
    }
    for start in (0..series.len()).rev() {
        let rest = &mut series[start..];
        for k in 2..rest.len() {
            rest[k] *= 0.5;
            rest[k - 2] += rest[k];
        }
    }
    series
}
