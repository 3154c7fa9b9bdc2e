//! The cable and its encoder grow with temperature.

use crate::laws::Linear;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of cable and encoder, see above",
    source: "C9",
    hook: Hook::CableSensor,
    family: Family::Drift,
    needs: &[Need::Temperature, Need::Cable],
    parameters: &[Parameter::size("m_per_degc", 0.0, 3e-4)],
    amplitudes: 2,
    follows: Follows::Temperature,
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

/// A shift at the mean distance (housing and cable), and what grows with the distance beyond that.
pub(crate) const LAW: Linear = Linear(|input| {
    let (warming, length_m) = (input.context.warming_k.as_ref()?, input.reading()?);
    let mean = input.context.mean_length_m();
    let beyond = warming.iter().zip(length_m);
    let beyond = beyond.map(|(warming, length)| warming * (length / mean - 1.0));
    Some(vec![warming.clone(), beyond.collect()])
});
