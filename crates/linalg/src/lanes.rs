//! Products and differences of vectors, some numbers at a time. What is said register by register is so at every level of
//! optimisation, and for the registers of the processor that runs it.

use pulp::{Arch, Simd, WithSimd};

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

/// Euclidean norm; entries of any size are squared without overflow or underflow.
pub(crate) fn norm(values: &[f64]) -> f64 {
    let largest = values
        .iter()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest
        * values
            .iter()
            .map(|value| (value / largest).powi(2))
            .sum::<f64>()
            .sqrt()
}

/// `into` less `factor` times `x`.
#[inline(always)]
pub(crate) fn subtract(into: &mut [f64], factor: f64, x: &[f64]) {
    for (into, x) in into.iter_mut().zip(x) {
        *into -= factor * x;
    }
}

/// Partial sums of a [`dot`].
const SUMS: usize = 8;

/// Sum of products, of as many as the shorter has. It is the same on every machine: eight partial sums, whatever the
/// width of the registers that hold them.
///
/// ```
/// assert_eq!(haptical_linalg::dot(&[1.0, 2.0, 3.0], &[1.0, 1.0, 2.0]), 9.0);
/// ```
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    Arch::new().dispatch(Dot { a, b })
}

/// Takes a vector's part along a direction of length 1 off it: its product with the direction.
///
/// ```
/// let mut vector = [3.0, 4.0];
/// assert_eq!(haptical_linalg::take_off(&mut vector, &[0.0, 1.0]), 4.0);
/// assert_eq!(vector, [3.0, 0.0]);
/// ```
pub fn take_off(vector: &mut [f64], direction: &[f64]) -> f64 {
    Arch::new().dispatch(TakeOff { vector, direction })
}

struct Dot<'v> {
    a: &'v [f64],
    b: &'v [f64],
}

impl WithSimd for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let count = self.a.len().min(self.b.len());
        let (a, a_rest) = self.a[..count].split_at(count - count % SUMS);
        let (b, b_rest) = self.b[..count].split_at(count - count % SUMS);
        // registers of four numbers are two of them, and so on
        let registers = SUMS / S::F64_LANES;
        let (a, b) = (S::as_simd_f64s(a).0, S::as_simd_f64s(b).0);
        let mut partial = [simd.splat_f64s(0.0); SUMS];
        for (a, b) in a.chunks_exact(registers).zip(b.chunks_exact(registers)) {
            for register in 0..registers {
                let product = simd.mul_f64s(a[register], b[register]);
                partial[register] = simd.add_f64s(partial[register], product);
            }
        }
        let mut sums = [0.0; SUMS];
        let into = S::as_mut_simd_f64s(&mut sums).0;
        into.copy_from_slice(&partial[..registers]);
        let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
        sums.iter().sum::<f64>() + rest
    }
}

struct TakeOff<'v> {
    vector: &'v mut [f64],
    direction: &'v [f64],
}

impl WithSimd for TakeOff<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { vector, direction } = self;
        let (a, b) = (direction, &*vector);
        let along = Dot { a, b }.with_simd(simd);
        let count = direction.len().min(vector.len());
        let (into, into_rest) = S::as_mut_simd_f64s(&mut vector[..count]);
        let (x, x_rest) = S::as_simd_f64s(&direction[..count]);
        let factor = simd.splat_f64s(along);
        for (into, x) in into.iter_mut().zip(x) {
            *into = simd.sub_f64s(*into, simd.mul_f64s(factor, *x));
        }
        subtract(into_rest, along, x_rest);
        along
    }
}
