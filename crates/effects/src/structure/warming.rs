//! All links grow with temperature: the way from base to handle does.

use nalgebra::Vector3;

use crate::laws::InStreams;
use crate::{Family, Follows, Hook, LawError, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "thermal-drift",
    meaning: "lengths grow with the temperature",
    inspect: "warm-up, and the temperature of the room",
    adds: "growth of all links, see above",
    source: "D8",
    hook: Hook::Structure,
    family: Family::Drift,
    needs: &[Need::Temperature, Need::Chain],
    parameters: &[Parameter::size("m_per_degc", 0.0, 3e-4)],
    follows: Follows::Temperature,
    law_error: LawError::DRIFT,
    ..Spec::COMMON
};

pub(crate) const LAW: InStreams = InStreams(|input| {
    let context = input.context;
    let warming = context.warming_k.as_ref()?;
    let mean = context.mean_length_m();
    let grown = |row: usize| context.way_from_base(row) * (warming[row] / mean);
    Some(vec![context.handle(|row| (grown(row), Vector3::zeros()))])
});
