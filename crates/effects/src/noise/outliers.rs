//! Single readings far from the rest.

use crate::{Hook, LogFault, Parameter, Spec};

/// Single readings far from the rest.
pub const SPEC: Spec = Spec {
    name: "outliers",
    meaning: "single readings stand far from the rest",
    inspect: "loose plugs, and the receiver of that channel",
    adds: "single wild readings",
    source: "F",
    hook: Hook::Readings,
    parameters: &[Parameter::size("share", 0.0, 1.0)],
    log_fault: Some(LogFault::Wild),
    ..Spec::COMMON
};
