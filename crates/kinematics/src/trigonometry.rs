//! Sine, cosine, arctangent and square root of fixed work, without a panic path, usable in constants.
//!
//! `libm` reduces large angles by a table and a loop: its worst case is hundreds of instructions, its code
//! indexes arrays, and the compiler cannot evaluate it. [`Chain`](crate::Chain) keeps to it for its range;
//! [`PreparedChain`](crate::PreparedChain), which need not, takes the functions below. The reduction to a
//! quadrant is that of Cody and Waite in two parts, the polynomials are fdlibm's.
//!
//! The constants are public for code that works sines out in lanes of its own.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// Largest magnitude of an angle that is served: the product of a quadrant's number (20 bits) and the
/// 33 bits of the first part of pi/2 is exact up to 2^20 quadrants, 1.6e6 rad.
pub const LARGEST_RAD: f64 = 1e6;

/// 1.5 2^52: a number below 2^51 added to it is rounded to an integer, which is in its low bits.
pub const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// First 33 bits of pi/2, and pi/2 less these: the split of fdlibm, `e_rem_pio2.c`.
pub const QUADRANT_HIGH: f64 = 1.570_796_326_734_125_6;
/// See [`QUADRANT_HIGH`].
pub const QUADRANT_LOW: f64 = 6.077_100_506_506_192e-11;

/// sin r = r + r^3 (S0 + S1 r^2 + ...), |r| <= pi/4, to 2^-58: fdlibm, `k_sin.c`.
pub const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_49,
    -0.000_198_412_698_298_579_5,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// cos r = 1 - r^2/2 + r^4 (C0 + C1 r^2 + ...), |r| <= pi/4, to 2^-58: fdlibm, `k_cos.c`.
pub const COSINE: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_411,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];
/// atan t = t - t^3 (A0 + A1 t^2 + ...), |t| <= 7/16, to 2^-60: fdlibm, `s_atan.c`.
const ARCTANGENT: [f64; 11] = [
    0.333_333_333_333_329_3,
    -0.199_999_999_998_764_83,
    0.142_857_142_725_034_66,
    -0.111_111_104_054_623_56,
    0.090_908_871_334_365_07,
    -0.076_918_762_050_448_3,
    0.066_610_731_373_875_31,
    -0.058_335_701_337_905_735,
    0.049_768_779_946_159_324,
    -0.036_531_572_744_216_916,
    0.016_285_820_115_365_782,
];
/// What is missing of pi/4 in its rounded value.
const FRAC_PI_4_LOW: f64 = 3.061_616_997_868_383e-17;
/// tan(pi/8) rounded up: beyond it the next eighth of a turn is nearer.
const EIGHTH: f64 = 0.414_213_562_373_095_1;

/// Sine and cosine of what is left of an angle within its quadrant, whose number is in the low bits of
/// the first result. `$all` puts a number into all lanes.
///
/// One text for one angle and for lanes of angles, so that both have the same bits: a constant function
/// cannot be generic over the two. No fused multiply-add, so the bits are the same on every machine.
macro_rules! within_quadrant {
    ($angle_rad:expr, $all:path) => {{
        let rounding = $all(ROUNDING);
        let shifted = $angle_rad * $all(FRAC_2_PI) + rounding;
        let quadrants = shifted - rounding;
        let r = ($angle_rad - quadrants * $all(QUADRANT_HIGH)) - quadrants * $all(QUADRANT_LOW);
        let z = r * r;
        let w = z * z;
        let [s0, s1, s2, s3, s4, s5] = SINE;
        let [c0, c1, c2, c3, c4, c5] = COSINE;
        // even and odd powers apart: two short chains instead of a long one
        let cubic = ($all(s0) + w * ($all(s2) + w * $all(s4)))
            + z * ($all(s1) + w * ($all(s3) + w * $all(s5)));
        let quartic = ($all(c0) + w * ($all(c2) + w * $all(c4)))
            + z * ($all(c1) + w * ($all(c3) + w * $all(c5)));
        let sine = r + z * r * cubic;
        let cosine = $all(1.0) - ($all(0.5) * z - w * quartic);
        (shifted, sine, cosine)
    }};
}
pub(crate) use within_quadrant;

const fn one(number: f64) -> f64 {
    number
}

/// Sine and cosine of `angle_rad`, each within 2.3e-16 for magnitudes up to [`LARGEST_RAD`].
///
/// Beyond that the digits are lost, but the result of a finite angle up to 1e15 is still finite; it is
/// for the caller to refuse such an angle. NaN for an angle that is not finite.
///
/// Source: Cody & Waite, Software Manual for the Elementary Functions, chapter 8 (reduction); fdlibm
/// (polynomials).
///
/// ```
/// let (sine, cosine) = haptical_kinematics::trigonometry::sine_cosine(2.0);
/// assert!((sine - 2f64.sin()).abs() < 2.3e-16 && (cosine - 2f64.cos()).abs() < 2.3e-16);
/// ```
#[must_use]
#[inline]
pub const fn sine_cosine(angle_rad: f64) -> (f64, f64) {
    let (shifted, sine, cosine) = within_quadrant!(angle_rad, one);
    let quadrant = shifted.to_bits();
    let (sine, cosine) = if quadrant & 1 == 0 {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    // sine changes its sign in quadrants 2 and 3, cosine in 1 and 2
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(sine.to_bits() ^ sine_sign),
        f64::from_bits(cosine.to_bits() ^ cosine_sign),
    )
}

/// Arctangent of `t` in rad, |t| <= 7/16, within two units in the last place.
///
/// Source: fdlibm, `s_atan.c`.
///
/// ```
/// let angle_rad = haptical_kinematics::trigonometry::small_arctangent(0.25);
/// assert!((angle_rad - 0.25f64.atan()).abs() < 1e-16);
/// ```
#[must_use]
#[inline]
pub const fn small_arctangent(t: f64) -> f64 {
    let z = t * t;
    let w = z * z;
    let [a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10] = ARCTANGENT;
    let even = z * (a0 + w * (a2 + w * (a4 + w * (a6 + w * (a8 + w * a10)))));
    let odd = w * (a1 + w * (a3 + w * (a5 + w * (a7 + w * a9))));
    t - t * (even + odd)
}

/// Angle of the point (`x`, `y`) in rad within `[-pi, pi]`, within 4.5e-16; NaN at (0, 0).
///
/// The nearest of the angles 0, pi/4 and pi/2 of the first quadrant is taken off, so that what is left
/// has a tangent of at most tan(pi/8).
///
/// Source: fdlibm, `s_atan.c` (polynomial).
///
/// ```
/// let angle_rad = haptical_kinematics::trigonometry::arctangent2(-0.3, -2.0);
/// assert!((angle_rad - (-0.3f64).atan2(-2.0)).abs() < 4.5e-16);
/// ```
#[must_use]
#[inline]
pub const fn arctangent2(y: f64, x: f64) -> f64 {
    let (a, b) = (y.abs(), x.abs());
    let (numerator, denominator, base, base_low) = if a <= EIGHTH * b {
        (a, b, 0.0, 0.0)
    } else if b <= EIGHTH * a {
        (-b, a, FRAC_PI_2, 2.0 * FRAC_PI_4_LOW)
    } else {
        (a - b, a + b, FRAC_PI_4, FRAC_PI_4_LOW)
    };
    let first = base + (base_low + small_arctangent(numerator / denominator));
    let upper = if x < 0.0 {
        PI - (first - 4.0 * FRAC_PI_4_LOW)
    } else {
        first
    };
    if y < 0.0 { -upper } else { upper }
}

/// Square root by Newton's method, for constants: 0 for what is not positive and finite.
///
/// Elsewhere take `libm::sqrt`, a single instruction that the compiler cannot evaluate.
///
/// ```
/// const ROOT: f64 = haptical_kinematics::trigonometry::constant_square_root(2.0);
/// assert!((ROOT - 2f64.sqrt()).abs() < 4.5e-16);
/// ```
#[must_use]
pub const fn constant_square_root(x: f64) -> f64 {
    let positive = x > 0.0 && x.is_finite();
    if !positive {
        return 0.0;
    }
    // halving the exponent gives the root within a factor; each step doubles the digits
    let mut root = f64::from_bits((x.to_bits() >> 1) + 0x1FF8_0000_0000_0000);
    let mut step = 0;
    while step < 6 {
        root = 0.5 * (root + x / root);
        step += 1;
    }
    root
}
