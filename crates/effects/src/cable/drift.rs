//! The zero of the cable encoder drifts in time.

use crate::laws::Drift;
use crate::{Hook, LogFault, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-drift",
    meaning: "the cable encoder's zero drifts with time",
    inspect: "warm-up of the encoder, and creep of the cable",
    adds: "c t",
    source: "C10",
    hook: Hook::CableSensor,
    needs: &[Need::Time, Need::Cable],
    parameters: &[Parameter::size("m_per_s", 0.0, 1e-4)],
    log_fault: Some(LogFault::Drift),
    ..Drift::SPEC
};

pub(crate) const LAW: Drift = Drift;
