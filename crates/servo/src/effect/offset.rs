//! A joint that stands beside its command by a constant: theta = u + o.

/// The zero of the joint's sensor, or of its horn on the shaft.
pub(crate) const NAME: &str = "joint-offset";

/// Column of the offset.
pub(crate) fn column(rows: usize) -> Vec<f64> {
    vec![1.0; rows]
}
