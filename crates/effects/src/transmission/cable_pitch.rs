//! Pitch of the helix and cables that walk or cross: to leading order an even term, and a cubic one where the cable
//! does not start in the middle of its drum.

use crate::laws::Linear;
use crate::{Family, Follows, Hook, LawError, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-pitch",
    meaning: "the cable walks along its drum",
    inspect: "the groove and the lead of the cable on the drum",
    adds: "c_2 theta^2 + c_3 theta^3",
    source: "A8",
    hook: Hook::Transmission,
    family: Family::Shape,
    parameters: &[Parameter::size("quadratic_per_rad", 0.0, 0.1)],
    amplitudes: 2,
    follows: Follows::Angle,
    law_error: LawError::SHAPE,
    ..Spec::COMMON
};

pub(crate) const LAW: Linear = Linear(|input| {
    let power = |exponent: i32| Some(input.reading()?.iter().map(|q| q.powi(exponent)).collect());
    Some(vec![power(2)?, power(3)?])
});
