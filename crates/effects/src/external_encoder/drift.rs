//! The zero of an external encoder drifts in time.

use crate::laws::Drift;
use crate::{Hook, Need, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "external-encoder-drift",
    meaning: "the zero of an external encoder drifts",
    inspect: "its clamp, and its temperature",
    adds: "c t",
    source: "B4",
    hook: Hook::ExternalEncoder,
    needs: &[Need::Time, Need::Output],
    ..Drift::SPEC
};

pub(crate) const LAW: Drift = Drift;
