//! The home of a joint.

use crate::{Family, Follows, Hook, Need, Spec};

/// The home of a joint.
pub const SPEC: Spec = Spec {
    name: "joint-offset",
    meaning: "the home of the joint is not where the device file says",
    inspect: "the homing stop or the reference pose",
    adds: "other numbers than an earlier model",
    hook: Hook::BaseModel,
    family: Family::Stated,
    needs: &[Need::EarlierModel],
    follows: Follows::Angle,
    ..Spec::COMMON
};
