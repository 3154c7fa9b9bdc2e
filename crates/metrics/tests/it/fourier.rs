//! Fourier transforms against their sums: lengths of one, two, powers of two, others and primes.

use haptical_metrics::{Complex, Fourier};

#[test]
fn the_transform_is_its_sum() {
    for count in [1, 2, 5, 12, 16, 97] {
        let values: Vec<f64> = (0..count).map(|n| (1.7 * (n * n) as f64).sin()).collect();
        let mut fourier = Fourier::new(count);
        // what was there before is of no account
        fourier.transform(vec![f64::NAN; count]);
        let found = fourier.transform(values.iter().copied());
        assert_eq!(found.len(), count);
        for (bin, found) in found.iter().enumerate() {
            let turn = |n: usize| -std::f64::consts::TAU * (bin * n) as f64 / count as f64;
            let terms = values.iter().enumerate();
            let sum: Complex<f64> = terms.map(|(n, x)| Complex::from_polar(*x, turn(n))).sum();
            assert!(
                (found - sum).norm() < 1e-12,
                "{count}, {bin}: {found} for {sum}"
            );
        }
    }
}

#[test]
fn missing_values_are_zero_and_further_ones_are_left_out() {
    let mut fourier = Fourier::new(4);
    let full = fourier.transform([1.0, -2.0, 0.0, 0.0]).to_vec();
    assert_eq!(fourier.transform([1.0, -2.0]), full);
    assert_eq!(fourier.transform([1.0, -2.0, 0.0, 0.0, 9.0]), full);
    assert!(Fourier::new(0).transform([1.0]).is_empty());
}
