//! Numbers of the base model that an earlier model has otherwise.

use crate::{Follows, Hook, Need, Spec};

mod joint_offset;
mod link_geometry;
mod parallelogram_error;

pub use joint_offset::SPEC as JOINT_OFFSET;
pub use link_geometry::SPEC as LINK_GEOMETRY;
pub use parallelogram_error::SPEC as PARALLELOGRAM_ERROR;

/// What these effects have in common.
const FOUND: Spec = Spec {
    adds: "other numbers than an earlier model",
    hook: Hook::BaseModel,
    needs: &[Need::EarlierModel],
    follows: Follows::Angle,
    ..Spec::COMMON
};
