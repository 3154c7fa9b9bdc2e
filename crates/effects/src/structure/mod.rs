//! Effects of joints behind their external encoders, of links, base and handle: the chain alone sees them.

pub(crate) mod axis_wobble;
pub(crate) mod base_compliance;
pub(crate) mod joint_compliance;
pub(crate) mod lateral_compliance;
pub(crate) mod tool_changed;
pub(crate) mod tool_compliance;
pub(crate) mod tracker_latency;
pub(crate) mod tracker_moved;
pub(crate) mod tracker_scale;
pub(crate) mod warming;

pub use joint_compliance::SPEC as JOINT_COMPLIANCE;
pub use tool_changed::SPEC as TOOL_CHANGED;

fn norm(parts: &[f64]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}
