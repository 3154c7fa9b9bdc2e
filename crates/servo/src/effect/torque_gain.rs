//! A torque that is reported with another scale.

use super::Spec;

/// Scale of the torques.
pub(crate) const SPEC: Spec = Spec {
    name: "torque-gain",
    meaning: "the drive reports its torque with another scale",
    inspect: "the constant between current and torque in the firmware, and its version",
    parameters: &["factor"],
};
