//! Sines and cosines of four angles at a time: Cody and Waite's reduction, fdlibm's polynomials.
//!
//! `libm` takes one angle at a time and branches on its size. Here the lanes run through the same
//! arithmetic, whatever the angle; without fused multiply-add, so the bits are the same on every machine.

use core::f64::consts::FRAC_2_PI;

use wide::bytemuck::cast;
use wide::{f64x4, u64x4};

use crate::quadrant::{COSINE, QUADRANT_HIGH, QUADRANT_LOW, ROUNDING, SINE};

/// c0 + c1 z + ... + c5 z^5, even and odd powers apart: two short chains instead of a long one.
#[inline(always)]
fn polynomial(z: f64x4, w: f64x4, coefficients: [f64; 6]) -> f64x4 {
    // not by `map`, which stays a call
    let [c0, c1, c2, c3, c4, c5] = coefficients;
    let even = f64x4::splat(c0) + w * (f64x4::splat(c2) + w * f64x4::splat(c4));
    let odd = f64x4::splat(c1) + w * (f64x4::splat(c3) + w * f64x4::splat(c5));
    even + z * odd
}

/// Sines and cosines of angles of at most [`LARGEST_RAD`], each within 2.3e-16.
#[inline(always)]
fn four(angle_rad: f64x4) -> (f64x4, f64x4) {
    let rounding = f64x4::splat(ROUNDING);
    let shifted = angle_rad * f64x4::splat(FRAC_2_PI) + rounding;
    let quadrants = shifted - rounding;
    let r = (angle_rad - quadrants * f64x4::splat(QUADRANT_HIGH))
        - quadrants * f64x4::splat(QUADRANT_LOW);

    let z = r * r;
    let w = z * z;
    let sine = r + z * r * polynomial(z, w, SINE);
    let less = f64x4::splat(0.5) * z - w * polynomial(z, w, COSINE);
    let cosine = f64x4::splat(1.0) - less;

    // an odd quadrant swaps the two; sine changes its sign in quadrants 2 and 3, cosine in 1 and 2
    let quadrant: u64x4 = cast(shifted);
    let (sine, cosine): (u64x4, u64x4) = (cast(sine), cast(cosine));
    let (one, two) = (u64x4::splat(1), u64x4::splat(2));
    let odd = u64x4::splat(0) - (quadrant & one);
    let swap = (sine ^ cosine) & odd;
    let sine_sign = (quadrant & two) << 62_u32;
    let cosine_sign = ((quadrant + one) & two) << 62_u32;
    (
        cast(sine ^ swap ^ sine_sign),
        cast(cosine ^ swap ^ cosine_sign),
    )
}

/// Sines and cosines of angles of at most [`LARGEST_RAD`], each within 2.3e-16.
#[inline(always)]
pub(crate) fn sines_cosines<const N: usize>(angles_rad: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    let (angles, rest) = angles_rad.as_chunks::<4>();
    let (sines_of_four, sines_rest) = sines.as_chunks_mut::<4>();
    let (cosines_of_four, cosines_rest) = cosines.as_chunks_mut::<4>();
    for ((angles, sines), cosines) in angles.iter().zip(sines_of_four).zip(cosines_of_four) {
        let (sine, cosine) = four(f64x4::new(*angles));
        (*sines, *cosines) = (sine.to_array(), cosine.to_array());
    }
    if !rest.is_empty() {
        let mut angles = [0.0; 4];
        angles[..rest.len()].copy_from_slice(rest);
        let (sine, cosine) = four(f64x4::new(angles));
        sines_rest.copy_from_slice(&sine.to_array()[..rest.len()]);
        cosines_rest.copy_from_slice(&cosine.to_array()[..rest.len()]);
    }
    (sines, cosines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrant::LARGEST_RAD;

    /// One unit in the last place of numbers just below 1 is 1.1e-16, `libm`'s error half of that.
    const TWO_UNITS: f64 = 2.3e-16;

    fn check(angles_rad: &[f64; 7]) {
        let (sines, cosines) = sines_cosines(angles_rad);
        for ((&angle, sine), cosine) in angles_rad.iter().zip(sines).zip(cosines) {
            let (expected_sine, expected_cosine) = libm::sincos(angle);
            let agrees = (sine - expected_sine).abs() < TWO_UNITS
                && (cosine - expected_cosine).abs() < TWO_UNITS;
            assert!(agrees, "{angle}: {sine}, {cosine}");
        }
    }

    #[test]
    fn a_grid_over_the_whole_range_agrees_with_libm() {
        for k in -200_000..200_000 {
            let k = f64::from(k);
            check(&core::array::from_fn(|i| k * 1e-4 + i as f64 * 1e-5));
            check(&core::array::from_fn(|i| k * 0.499_999 + i as f64 * 0.07));
        }
    }

    #[test]
    fn the_edges_of_quadrants_agree_with_libm() {
        for k in -1000..=1000 {
            let edge = f64::from(k) * core::f64::consts::FRAC_PI_4;
            check(&[
                edge.next_down(),
                edge,
                edge.next_up(),
                -edge,
                0.0,
                -1e-300,
                LARGEST_RAD,
            ]);
        }
    }
}
