//! A parallelogram whose links are not of their nominal lengths.

use crate::{Family, Follows, Hook, Need, Spec};

/// A parallelogram whose links are not of their nominal lengths.
pub const SPEC: Spec = Spec {
    name: "parallelogram-error",
    meaning: "the links of the parallelogram are not of the nominal lengths",
    inspect: "the distances of its pins",
    adds: "other numbers than an earlier model",
    hook: Hook::BaseModel,
    family: Family::Stated,
    needs: &[Need::EarlierModel],
    follows: Follows::Angle,
    ..Spec::COMMON
};
