//! Sine and cosine in lanes: Cody and Waite's reduction, fdlibm's polynomials.

use std::f64::consts::FRAC_2_PI;

pub(crate) use haptical_kinematics::trigonometry::LARGEST_RAD;
use haptical_kinematics::trigonometry::{COSINE, QUADRANT_HIGH, QUADRANT_LOW, ROUNDING, SINE};
use pulp::{Arch, Simd, WithSimd};

/// The polynomial of Horner's rule.
#[inline(always)]
fn polynomial<S: Simd>(simd: S, z: S::f64s, [c0, c1, c2, c3, c4, c5]: [f64; 6]) -> S::f64s {
    let step = |sum, c| simd.mul_add_e_f64s(sum, z, simd.splat_f64s(c));
    step(
        step(step(step(step(simd.splat_f64s(c5), c4), c3), c2), c1),
        c0,
    )
}

/// Sine and cosine of angles of at most [`LARGEST_RAD`], each within 2.3e-16.
#[inline(always)]
pub(crate) fn sine_cosine<S: Simd>(simd: S, angle_rad: S::f64s) -> (S::f64s, S::f64s) {
    let rounding = simd.splat_f64s(ROUNDING);
    let shifted = simd.mul_add_e_f64s(angle_rad, simd.splat_f64s(FRAC_2_PI), rounding);
    let quadrants = simd.sub_f64s(shifted, rounding);
    let less = |from, part: f64| simd.mul_add_e_f64s(quadrants, simd.splat_f64s(-part), from);
    let r = less(less(angle_rad, QUADRANT_HIGH), QUADRANT_LOW);

    let z = simd.mul_f64s(r, r);
    let sine = simd.mul_add_e_f64s(simd.mul_f64s(z, r), polynomial(simd, z, SINE), r);
    let one = simd.splat_f64s(1.0);
    let half = simd.mul_f64s(simd.splat_f64s(0.5), z);
    let nearly = simd.sub_f64s(one, half);
    // what 1 - z/2 lost by rounding comes back in the small part
    let lost = simd.sub_f64s(simd.sub_f64s(one, nearly), half);
    let small = simd.mul_add_e_f64s(simd.mul_f64s(z, z), polynomial(simd, z, COSINE), lost);
    let cosine = simd.add_f64s(nearly, small);

    let quadrant = simd.transmute_u64s_f64s(shifted);
    let is_set = |bits, bit: u64| {
        let bit = simd.splat_u64s(bit);
        simd.equal_u64s(simd.and_u64s(bits, bit), bit)
    };
    let odd = is_set(quadrant, 1);
    let next = simd.add_u64s(quadrant, simd.splat_u64s(1));
    let signed = |value, negative| simd.select_f64s(negative, simd.neg_f64s(value), value);
    // sine changes its sign in quadrants 2 and 3, cosine in 1 and 2
    (
        signed(simd.select_f64s(odd, cosine, sine), is_set(quadrant, 2)),
        signed(simd.select_f64s(odd, sine, cosine), is_set(next, 2)),
    )
}

struct SinesCosines<'a> {
    angles_rad: &'a [f64],
    sines: &'a mut [f64],
    cosines: &'a mut [f64],
}

impl WithSimd for SinesCosines<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (angles, angles_rest) = S::as_simd_f64s(self.angles_rad);
        let (sines, sines_rest) = S::as_mut_simd_f64s(self.sines);
        let (cosines, cosines_rest) = S::as_mut_simd_f64s(self.cosines);
        for ((&angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            (*sine, *cosine) = sine_cosine(simd, angle);
        }
        let rest = angles_rest.iter().zip(sines_rest).zip(cosines_rest);
        for ((&angle, sine), cosine) in rest {
            let lanes = sine_cosine(simd, simd.splat_f64s(angle));
            (*sine, *cosine) = (simd.reduce_max_f64s(lanes.0), simd.reduce_max_f64s(lanes.1));
        }
    }
}

/// Sines and cosines of angles in rad, into slices of the same length; what is beyond the shortest of
/// the three is left alone.
///
/// Within 2.3e-16 of the true value for magnitudes up to 1e6 rad, as `libm` beyond; NaN for an angle
/// that is not finite. Source: Cody & Waite, *Software Manual for the Elementary Functions*, chapter 8
/// (reduction); fdlibm (polynomials).
///
/// ```
/// let (mut sines, mut cosines) = ([0.0; 3], [0.0; 3]);
/// haptical_batch::sines_cosines(&[0.0, 2.0, -1e9], &mut sines, &mut cosines);
/// assert_eq!((sines[0], cosines[0]), (0.0, 1.0));
/// assert!((sines[1] - 2f64.sin()).abs() < 2.3e-16);
/// assert!((cosines[2] - 1e9f64.cos()).abs() < 2.3e-16);
/// ```
pub fn sines_cosines(angles_rad: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    let length = angles_rad.len().min(sines.len()).min(cosines.len());
    let (angles_rad, sines) = (&angles_rad[..length], &mut sines[..length]);
    let cosines = &mut cosines[..length];
    Arch::new().dispatch(SinesCosines {
        angles_rad,
        sines,
        cosines,
    });
    for (index, &angle_rad) in angles_rad.iter().enumerate() {
        let is_served = angle_rad.abs() <= LARGEST_RAD;
        if !is_served {
            (sines[index], cosines[index]) = libm::sincos(angle_rad);
        }
    }
}
