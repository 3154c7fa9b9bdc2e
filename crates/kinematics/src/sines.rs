//! Sines and cosines of four angles at a time: [`sine_cosine`](crate::trigonometry::sine_cosine) in lanes,
//! with its bits, in a third of its time for a chain of seven joints.

use core::f64::consts::FRAC_2_PI;

use wide::bytemuck::cast;
use wide::{f64x4, u64x4};

use crate::trigonometry::{COSINE, QUADRANT_HIGH, QUADRANT_LOW, ROUNDING, SINE, within_quadrant};

/// Sines and cosines of angles of at most [`LARGEST_RAD`](crate::trigonometry::LARGEST_RAD).
#[inline(always)]
fn four(angle_rad: f64x4) -> (f64x4, f64x4) {
    let (shifted, sine, cosine) = within_quadrant!(angle_rad, f64x4::splat);
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

/// Sines and cosines of angles of at most [`LARGEST_RAD`](crate::trigonometry::LARGEST_RAD), each within 2.3e-16.
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
    use crate::trigonometry::{LARGEST_RAD, sine_cosine};

    /// Eleven angles run through two full chunks of lanes and a part of one.
    fn check(angles_rad: &[f64; 11]) {
        let (sines, cosines) = sines_cosines(angles_rad);
        for ((&angle, sine), cosine) in angles_rad.iter().zip(sines).zip(cosines) {
            let (expected_sine, expected_cosine) = sine_cosine(angle);
            let found = (sine.to_bits(), cosine.to_bits());
            let expected = (expected_sine.to_bits(), expected_cosine.to_bits());
            assert_eq!(found, expected, "{angle}");
        }
    }

    #[test]
    fn lanes_have_the_bits_of_single_angles() {
        for k in -200_000..200_000 {
            let k = f64::from(k);
            check(&core::array::from_fn(|i| k * 1e-4 + i as f64 * 1e-5));
            check(&core::array::from_fn(|i| k * 4.999_99 + i as f64 * 0.07));
        }
        for k in -1000..=1000 {
            let edge = f64::from(k) * core::f64::consts::FRAC_PI_4;
            let mut angles = [0.0; 11];
            angles[..8].copy_from_slice(&[
                edge.next_down(),
                edge,
                edge.next_up(),
                -edge,
                0.0,
                -1e-300,
                LARGEST_RAD,
                -LARGEST_RAD,
            ]);
            check(&angles);
        }
    }
}
