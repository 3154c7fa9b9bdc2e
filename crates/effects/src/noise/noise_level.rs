//! Noise of another size than stated.

use crate::{Hook, Parameter, Spec};

/// Noise of another size than stated.
pub const SPEC: Spec = Spec {
    name: "noise-level",
    meaning: "the noise is not of the stated size",
    inspect: "the stated figures, shielding and the encoders' mounting",
    adds: "noise of another size",
    source: "B6",
    hook: Hook::Readings,
    parameters: &[Parameter::size("ratio", 0.0, f64::MAX)],
    ..Spec::COMMON
};
