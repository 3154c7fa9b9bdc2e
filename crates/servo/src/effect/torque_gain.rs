//! A torque that is reported with another scale.

/// Scale of the torques.
pub(crate) const NAME: &str = "torque-gain";
