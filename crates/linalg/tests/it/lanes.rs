//! Sums of products have the same bits on every machine and at every level of optimisation.

use haptical_linalg::{dot, take_off};

/// The law as it is stated, one number after another: eight partial sums, added in order, then what is left over.
fn eight_sums(a: &[f64], b: &[f64]) -> f64 {
    let whole = a.len() - a.len() % 8;
    let mut sums = [0.0; 8];
    for entry in 0..whole {
        sums[entry % 8] += a[entry] * b[entry];
    }
    let rest: f64 = (whole..a.len()).map(|entry| a[entry] * b[entry]).sum();
    sums.iter().sum::<f64>() + rest
}

#[test]
fn bits_are_those_of_eight_sums() {
    let numbers = |seed: f64, count: usize| -> Vec<f64> {
        let entries = 0..count;
        entries
            .map(|k| (seed * (k as f64 + 1.0)).sin() * 10.0_f64.powi(k as i32 % 7 - 3))
            .collect()
    };
    for count in 0..70 {
        let (a, b) = (numbers(1.3, count), numbers(2.9, count));
        let along = eight_sums(&a, &b);
        assert_eq!(dot(&a, &b).to_bits(), along.to_bits(), "{count}");
        let mut left = a.clone();
        assert_eq!(
            take_off(&mut left, &b).to_bits(),
            eight_sums(&b, &a).to_bits(),
            "{count}"
        );
        let wanted: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - along * b).collect();
        assert_eq!(left, wanted, "{count}");
    }
    // as many as the shorter has
    assert_eq!(
        dot(&numbers(1.0, 20), &numbers(2.0, 9)),
        dot(&numbers(1.0, 9), &numbers(2.0, 9))
    );
}
