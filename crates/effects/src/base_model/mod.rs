//! Numbers of the base model that an earlier model has otherwise.

mod joint_offset;
mod link_geometry;
mod parallelogram_error;

pub use joint_offset::SPEC as JOINT_OFFSET;
pub use link_geometry::SPEC as LINK_GEOMETRY;
pub use parallelogram_error::SPEC as PARALLELOGRAM_ERROR;
