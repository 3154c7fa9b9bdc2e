//! Sine and cosine in lanes: Cody and Waite's reduction, fdlibm's polynomials.

use std::f64::consts::FRAC_2_PI;

use pulp::{Arch, Simd, WithSimd};

/// Largest magnitude that the lanes serve; beyond it `libm` does. The product of a quadrant's number
/// (17 bits here) and the 33 bits of the first part of pi/2 is exact.
pub(crate) const LARGEST_RAD: f64 = 1e5;

/// 1.5 2^52: a number below 2^51 added to it is rounded to an integer, which stands in its low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// First 33 bits of pi/2, and pi/2 less these: the split of fdlibm, `e_rem_pio2.c`.
const QUADRANT_HIGH: f64 = 1.570_796_326_734_125_6;
const QUADRANT_LOW: f64 = 6.077_100_506_506_192e-11;

/// sin r = r + r^3 (S0 + S1 r^2 + ...), |r| <= pi/4, to 2^-58: fdlibm, `k_sin.c`.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_49,
    -0.000_198_412_698_298_579_5,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// cos r = 1 - r^2/2 + r^4 (C0 + C1 r^2 + ...), |r| <= pi/4, to 2^-58: fdlibm, `k_cos.c`.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_411,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

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
/// Within 2.3e-16 of the true value for magnitudes up to 1e5 rad, as `libm` beyond; NaN for an angle
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
