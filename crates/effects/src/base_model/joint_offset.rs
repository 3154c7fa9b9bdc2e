//! The home of a joint.

use crate::Spec;
use crate::base_model::FOUND;

/// The home of a joint.
pub const SPEC: Spec = Spec {
    name: "joint-offset",
    meaning: "the home of the joint is not where the device file, or its command, says",
    inspect: "the homing stop or the reference pose",
    ..FOUND
};
