//! Causes of a joint that does not follow its command.

// `servo_alone::answer`
/// Share of a gap above which all of it is accounted for.
pub(crate) const ALL_CLOSED: f64 = 0.95;
/// Least floor, so that shares of noiseless logs are finite.
pub(crate) const LEAST_FLOOR: f64 = 1e-7;

// `servo_alone::causes`
/// Probability of a class of names that closes most of a gap.
pub(crate) const SURE_CLASS: f64 = 0.95;

// `servo_alone`
/// Torque scales that are known no better than this say nothing: the device file's way to call its torques untrusted.
pub(crate) const UNTRUSTED_SCALE: f64 = 1.0;
