//! Constants of a sine and cosine of fixed work: Cody and Waite's reduction to a quadrant, fdlibm's polynomials.
//!
//! For code that works them out in lanes of its own; [`crate::PreparedChain`] does.

/// Largest magnitude that the lanes serve; beyond it `libm` does. The product of a quadrant's number
/// (17 bits here) and the 33 bits of the first part of pi/2 is exact.
pub const LARGEST_RAD: f64 = 1e5;

/// 1.5 2^52: a number below 2^51 added to it is rounded to an integer, which stands in its low bits.
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
