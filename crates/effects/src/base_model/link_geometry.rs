//! Lengths and twists of the links.

use crate::{Family, Follows, Hook, Need, Spec};

/// Lengths and twists of the links.
pub const SPEC: Spec = Spec {
    name: "link-geometry",
    meaning: "lengths or twists of the links are not the nominal ones",
    inspect: "the device file against the drawing",
    adds: "other numbers than an earlier model",
    hook: Hook::BaseModel,
    family: Family::Stated,
    needs: &[Need::EarlierModel],
    follows: Follows::Angle,
    ..Spec::COMMON
};
