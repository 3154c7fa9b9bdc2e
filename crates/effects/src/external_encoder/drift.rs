//! The zero of an external encoder drifts in time.

use crate::laws::Drift;
use crate::{Hook, LogFault, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "external-encoder-drift",
    meaning: "the zero of an external encoder drifts",
    inspect: "its clamp, and its temperature",
    adds: "c t",
    source: "B4",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Time, Need::Output],
    log_fault: Some(LogFault::Drift),
    ..Drift::SPEC
};

pub(crate) const LAW: Drift = Drift;
