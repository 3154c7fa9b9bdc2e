//! Products and differences of vectors, some numbers at a time.

/// Numbers that are worked on together.
pub(crate) const LANES: usize = 4;

/// Sum of products; a single sum would wait for itself at every entry.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// The entries of `into` that `x` has, less `factor` times it.
pub(crate) fn subtract(into: &mut [f64], factor: f64, x: &[f64]) {
    let (into, into_rest) = into[..x.len()].as_chunks_mut::<LANES>();
    let (x, x_rest) = x.as_chunks::<LANES>();
    for (into, x) in into.iter_mut().zip(x) {
        // by value, so that the compiler need not fear that the two overlap
        let mut lanes = *into;
        for lane in 0..LANES {
            lanes[lane] -= factor * x[lane];
        }
        *into = lanes;
    }
    for (into, x) in into_rest.iter_mut().zip(x_rest) {
        *into -= factor * x;
    }
}
