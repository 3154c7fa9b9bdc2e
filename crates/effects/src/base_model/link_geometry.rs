//! Lengths and twists of the links.

use crate::Spec;
use crate::base_model::FOUND;

/// Lengths and twists of the links.
pub const SPEC: Spec = Spec {
    name: "link-geometry",
    meaning: "lengths or twists of the links are not the nominal ones",
    inspect: "the device file against the drawing",
    ..FOUND
};
