//! A moving arm's gap in words.

// `moving::between`
/// Standard deviation of a stiffness by the torque that a link asks for, as a share: masses are known to a tenth (A157).
pub(crate) const STIFFNESS_SD: f64 = 0.07;

// `moving::words`
/// Share of its probability that an effect keeps which may as well be the freedom of the base model. Choice: either is as likely.
pub(crate) const LESS_BY_FREEDOM: f64 = 0.5;

// `moving::words`, what a gap follows
/// A quantity is named where functions of it explain this share of a gap, and that one of what the best does.
pub(crate) const FOLLOWED_SHARE: f64 = 0.2;
pub(crate) const FOLLOWED_OF_MOST: f64 = 0.6;

// `moving::warnings`
/// No joint of an arm turns faster \[rad/s\].
pub(crate) const TOO_FAST_RAD_PER_S: f64 = 25.0;
/// Outside this a joint's unit is another one than that of a log.
pub(crate) const SAME_UNIT: std::ops::Range<f64> = 0.02..30.0;
