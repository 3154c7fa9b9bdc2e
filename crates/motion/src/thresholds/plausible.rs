//! How far a sound arm's numbers may be from its model's. What stays within is calibration and no gap.
//!
//! The limits are two standard deviations of what the base model allows for (docs/assumptions.md, A157).

/// A number is never further off than this many of its standard deviations: a gap stays a gap, however many rows would rather have
/// it otherwise.
pub(crate) const LIMIT_SDS: f64 = 2.5;

/// Limit of a mass, its centre held, as a share of it.
pub(crate) const MASS: f64 = 0.10;
/// The same where the device file gives no mass, and a plausible one stands in its place.
pub(crate) const ASSUMED_MASS: f64 = 1.0;
/// Limit of each coordinate of a centre of mass \[m\].
pub(crate) const CENTRE_M: f64 = 0.005;
/// The same where the device file gives none.
pub(crate) const ASSUMED_CENTRE_M: f64 = 0.05;
/// Limit of an inertia about the centre of mass, its mass held, as a share of it.
pub(crate) const INERTIA: f64 = 0.10;
/// The same where the device file gives none.
pub(crate) const ASSUMED_INERTIA: f64 = 1.0;
/// Limit of an armature, as a share of it.
pub(crate) const ARMATURE: f64 = 0.10;
/// A joint's zero is off by as much in a sound arm \[rad\], \[m\].
pub(crate) const ZERO_RAD: f64 = 0.01;
pub(crate) const ZERO_M: f64 = 1e-3;
/// Limit of the delay between torques and positions, in steps of the log.
pub(crate) const DELAY_STEPS: f64 = 1.0;
/// Limit of a torque's offset, in standard deviations of the noise of a reading.
pub(crate) const OFFSET_NOISES: f64 = 0.5;
/// A log does not say when within a step its torques were read, or its commands sent: a uniform distribution over it.
pub(crate) const OF_STEP: f64 = 0.288_675_134_594_812_9;
