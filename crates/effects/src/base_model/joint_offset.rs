//! The home of a joint.

use crate::base_model::FOUND;
use crate::{Form, Spec};

/// The home of a joint.
pub const SPEC: Spec = Spec {
    name: "joint-offset",
    meaning: "the home of the joint is not where the device file, or its command, says",
    inspect: "the homing stop or the reference pose",
    form: Form::Offset,
    ..FOUND
};
