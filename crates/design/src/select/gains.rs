//! The gain of a criterion by one more pose: small determinants and traces, asked millions of times.

use nalgebra::allocator::Allocator;
use nalgebra::{Cholesky, DMatrix, DefaultAllocator, DimSub, Dyn, OMatrix, SMatrix};

/// Lanes of a dot product: so many sums run side by side.
const LANES: usize = 8;

/// Dot product in lanes: a fixed order, whatever the machine.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (rest_a, rest_b) = (left.remainder(), right.remainder());
    let mut sums = [0.0; LANES];
    for (a, b) in left.zip(right) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// ln det(I + G), and trace((I + G)^-1 H) where H is given, of a pose with `count` readings. Sizes known to the
/// compiler need no allocation, and this is asked millions of times.
pub(crate) fn gains(count: usize, spread: &[f64], gained: Option<&[f64]>) -> (f64, f64) {
    fn small_gain<D: DimSub<Dyn>>(
        spread: OMatrix<f64, D, D>,
        gained: Option<OMatrix<f64, D, D>>,
    ) -> (f64, f64)
    where
        DefaultAllocator: Allocator<D, D>,
    {
        let mut sum = spread;
        for index in 0..sum.nrows() {
            sum[(index, index)] += 1.0;
        }
        // what is not positive by rounding is worth nothing
        let Some(factor) = Cholesky::new(sum) else {
            return (0.0, 0.0);
        };
        let lower = factor.l_dirty();
        let logs = (0..lower.nrows()).map(|index| lower[(index, index)].ln());
        let log_det = 2.0 * logs.sum::<f64>();
        let trace = gained.map_or(0.0, |mut gained| {
            factor.solve_mut(&mut gained);
            (0..gained.nrows())
                .map(|index| gained[(index, index)])
                .sum()
        });
        (log_det, trace)
    }
    fn fixed<const Q: usize>(spread: &[f64], gained: Option<&[f64]>) -> (f64, f64) {
        let matrix = |entries: &[f64]| SMatrix::<f64, Q, Q>::from_column_slice(entries);
        small_gain(matrix(spread), gained.map(matrix))
    }
    match count {
        0 => (0.0, 0.0),
        1 => fixed::<1>(spread, gained),
        2 => fixed::<2>(spread, gained),
        3 => fixed::<3>(spread, gained),
        4 => fixed::<4>(spread, gained),
        5 => fixed::<5>(spread, gained),
        6 => fixed::<6>(spread, gained),
        7 => fixed::<7>(spread, gained),
        8 => fixed::<8>(spread, gained),
        _ => {
            let matrix = |entries: &[f64]| DMatrix::from_column_slice(count, count, entries);
            small_gain(matrix(spread), gained.map(matrix))
        }
    }
}
