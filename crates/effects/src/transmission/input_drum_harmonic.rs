//! Orders of the motor's angle above the first, which the base model has for its input drum.

use crate::laws::Harmonic;
use crate::{Form, Hook, Parameter, Shape, Spec};

/// The error repeats with the turns of the motor.
pub const SPEC: Spec = Spec {
    name: "input-drum-harmonic",
    meaning: "the error repeats with the turns of the motor",
    inspect: "the input drum's run-out, lumps of the cable and the coupling",
    adds: "A cos(k R theta - phase), k = 2, 3, 4",
    source: "A10",
    hook: Hook::Transmission,
    form: Form::Harmonic(None),
    parameters: &[
        Parameter::size("amplitude_rad", 0.0, 0.05),
        Parameter::phase(),
        Parameter::number("order", 100.0),
    ],
    shape: Shape::Listed(&[2.0, 3.0, 4.0]),
    ..Harmonic::SPEC
};

pub(crate) const LAW: Harmonic = Harmonic;
