//! A position that answers with another size: theta = g u + o, a sensor or a gear of another scale.

/// Scale of the answer.
pub(crate) const NAME: &str = "servo-gain";
