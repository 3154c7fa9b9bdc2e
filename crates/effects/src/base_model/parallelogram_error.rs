//! A parallelogram whose links are not of their nominal lengths.

use crate::Spec;
use crate::base_model::FOUND;

/// A parallelogram whose links are not of their nominal lengths.
pub const SPEC: Spec = Spec {
    name: "parallelogram-error",
    meaning: "the links of the parallelogram are not of the nominal lengths",
    inspect: "the distances of its pins",
    ..FOUND
};
