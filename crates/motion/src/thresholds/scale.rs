//! A torque's sign, scale and unit.

/// A slope is known where three of its standard deviations are below this share of it, or of 1.
pub(crate) const KNOWN_SLOPE: f64 = 0.15;
/// A torque is a multiple of what its links ask for where that and friction explain this share of it.
pub(crate) const FOLLOWS_LINKS: f64 = 0.7;
/// A torque is noise where it is no larger than this many times what its readings scatter by.
pub(crate) const NOISE_SCATTERS: f64 = 1.5;
/// It is silent where its square is below that of noise and of this share of what its links ask for, by so many standard deviations.
pub(crate) const SILENT_SHARE: f64 = 0.3;
pub(crate) const SILENT_SDS: f64 = 4.0;
/// Friction drives the motion where what it adds against the joint's speed is this share of the torque: no friction does, and a torque that
/// is read with another sign does.
pub(crate) const DRIVEN_SHARE: f64 = 0.3;
/// A slope below this is one of the other sign, as long as its size is that of a torque: of a joint whose links ask for next to nothing,
/// and whose rotor and friction ask for all, what little they ask for says nothing.
pub(crate) const OTHER_SIGN: f64 = -0.3;
/// Outside this it is another unit, where most joints are: no payload makes a torque smaller, nor all of them ten times larger.
pub(crate) const SAME_UNIT: std::ops::Range<f64> = 0.5..10.0;
