//! A joint that stands beside its command by a constant: theta = u + o.

use super::Spec;

/// The zero of the joint's sensor, or of its horn on the shaft.
pub(crate) const SPEC: Spec = Spec {
    name: "joint-offset",
    meaning: "the joint stands beside its command by a constant",
    inspect: "the zero of its sensor, and the horn on its shaft",
    parameters: &["offset_rad"],
};

/// Column of the offset.
pub(crate) fn column(rows: usize) -> Vec<f64> {
    vec![1.0; rows]
}
