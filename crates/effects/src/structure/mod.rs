//! Effects of joints behind their external encoders, of links, base and handle: the chain alone sees them.

pub(crate) mod axis_wobble;
pub(crate) mod base_compliance;
pub(crate) mod joint_compliance;
pub(crate) mod tool_changed;
pub(crate) mod tool_compliance;
pub(crate) mod tracker_moved;
pub(crate) mod warming;

pub use axis_wobble::SPEC as AXIS_WOBBLE;
pub use base_compliance::SPEC as BASE_COMPLIANCE;
pub use joint_compliance::SPEC as JOINT_COMPLIANCE;
pub use tool_changed::SPEC as TOOL_CHANGED;
pub use tool_compliance::SPEC as TOOL_COMPLIANCE;
pub use warming::SPEC as WARMING;
