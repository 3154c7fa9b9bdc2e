//! Products and differences of vectors, some numbers at a time.

/// Numbers that are worked on together.
const LANES: usize = 4;

/// Sum of products, of as many as the shorter has; a single sum would wait for itself at every entry.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, a_rest) = a[..count].as_chunks::<LANES>();
    let (b, b_rest) = b[..count].as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// `into` less `factor` times `x`.
pub(crate) fn subtract(into: &mut [f64], factor: f64, x: &[f64]) {
    for (into, x) in into.iter_mut().zip(x) {
        *into -= factor * x;
    }
}
