//! Moments at which a channel reads 0, or one value, whatever moves.

use crate::{Hook, Parameter, Spec};

/// Moments at which a channel reads 0, or one value, whatever moves.
pub const SPEC: Spec = Spec {
    name: "dropouts",
    meaning: "a channel reads 0, or one value, for moments, whatever moves",
    inspect: "the bus and its cable, its load, and what the driver writes where a message is lost",
    adds: "one value in the place of a reading",
    source: "contract",
    hook: Hook::Readings,
    parameters: &[Parameter::size("share", 0.0, 1.0)],
    ..Spec::COMMON
};
