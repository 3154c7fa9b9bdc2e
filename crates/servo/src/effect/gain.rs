//! A position that answers with another size: theta = g u + o, a sensor or a gear of another scale.

use super::Spec;

/// Scale of the answer.
pub(crate) const SPEC: Spec = Spec {
    name: "servo-gain",
    meaning: "the joint moves by a factor more, or less, than it is told",
    inspect: "the scale between counts and angles, and the range that the servo is calibrated to",
    parameters: &["factor"],
};
