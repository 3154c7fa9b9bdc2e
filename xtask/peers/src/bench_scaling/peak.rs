//! The most that one core computes: fused multiply-adds in lanes on numbers that never leave its registers.

use std::hint::black_box;
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};

/// Sums that grow at the same time: a sum waits four cycles for itself, and two are added to in every cycle.
const SUMS: usize = 12;
/// Fused multiply-adds of each sum between two looks at the clock: a few milliseconds.
const STEPS: usize = 1 << 20;
/// Looks at the clock.
const ROUNDS: usize = 40;

struct MultiplyAdd {
    steps: usize,
    factor: f64,
    term: f64,
}

impl WithSimd for MultiplyAdd {
    /// A number that hangs on all sums, and the lanes.
    type Output = (f64, usize);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (factor, term) = (simd.splat_f64s(self.factor), simd.splat_f64s(self.term));
        let mut sums = [simd.splat_f64s(1.0); SUMS];
        for _ in 0..self.steps {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(*sum, factor, term);
            }
        }
        let mut total = simd.splat_f64s(0.0);
        for sum in sums {
            total = simd.add_f64s(total, sum);
        }
        (simd.reduce_sum_f64s(total), S::F64_LANES)
    }
}

/// Floating-point operations a second of one core, a fused multiply-add counted as two; the most of some rounds.
/// The lanes are those that the fits use: of AVX2 on x86-64, whatever the processor has beyond.
pub(crate) fn flops_per_s() -> f64 {
    most_flops_per_s(ROUNDS, STEPS)
}

fn most_flops_per_s(rounds: usize, steps: usize) -> f64 {
    let arch = Arch::new();
    let mut most = 0.0_f64;
    for _ in 0..rounds {
        let from = Instant::now();
        let work = MultiplyAdd {
            steps,
            // towards 1, so that no number grows or becomes too small to be fast
            factor: black_box(0.5),
            term: black_box(0.5),
        };
        let (sum, lanes) = arch.dispatch(work);
        black_box(sum);
        let flops = 2.0 * (SUMS * steps * lanes) as f64;
        most = most.max(flops / from.elapsed().as_secs_f64());
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loop_does_what_is_counted() {
        let (factor, term) = (0.5, 0.25);
        let steps = 3;
        let work = MultiplyAdd {
            steps,
            factor,
            term,
        };
        let (sum, lanes) = Arch::new().dispatch(work);
        // 1 -> 0.75 -> 0.625 -> 0.5625 in every lane of every sum
        assert_eq!(sum, 0.5625 * (SUMS * lanes) as f64);
        assert!(lanes.is_power_of_two());
        let peak = most_flops_per_s(2, 10_000);
        assert!(peak > 1e7 && peak < 1e13, "{peak:e}");
    }
}
