//! The tracker's lengths are longer or shorter than the metre. All lengths of an arm take that up but those that a drive counts,
//! which a slide's ratio does.

use crate::laws::{Input, Law};
use crate::{Absorbed, Hook, Need, Parameter, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "tracker-scale",
    meaning: "the tracker's lengths are not true",
    inspect: "the tracker with a length standard",
    adds: "s p",
    hook: Hook::Tracker,
    needs: &[Need::Position],
    parameters: &[Parameter::size("scale", 0.0, 0.05)],
    absorbed_by: Absorbed::ByLengths,
    look_alikes: &["ratio-error"],
    ..Spec::COMMON
};

pub(crate) const LAW: TrackerScale = TrackerScale;

#[derive(Debug)]
pub(crate) struct TrackerScale;

impl Law for TrackerScale {
    /// Along the tracker's own axes: what is tracked is farther from it by that share.
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        Some(vec![input.context.tracker_scaled()])
    }
}
