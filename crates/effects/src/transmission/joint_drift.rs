//! The zero of a drive drifts in time, steadily or until it settles, or follows the temperature.

use crate::laws::{Drift, Linear, REFERENCE, Warm};
use crate::{Follows, Form, Hook, Need, Parameter, Shape, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "joint-drift",
    meaning: "the joint's zero drifts with time or temperature",
    inspect: "warm-up, and the cable's tension before and after",
    adds: "c t",
    hook: Hook::Transmission,
    needs: &[Need::Time],
    look_alikes: &["capstan-creep"],
    ..Drift::SPEC
};
/// The same with temperature.
pub(crate) const WARM: Spec = Spec {
    adds: "c (T - mean T)",
    form: Form::Warming,
    source: "A14",
    needs: &[Need::Temperature],
    parameters: &[Parameter::size("rad_per_degc", 0.0, 2e-3)],
    further: &[REFERENCE],
    shape: Shape::NONE,
    follows: Follows::Temperature,
    look_alikes: &[],
    ..SPEC
};

pub(crate) const LAW: Drift = Drift;

pub(crate) const WARM_LAW: Warm<Linear> =
    Warm(Linear(|input| Some(vec![input.context.warming_k.clone()?])));
