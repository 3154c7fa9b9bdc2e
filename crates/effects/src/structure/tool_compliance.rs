//! The handle's fastening gives way along the hand's force.

use nalgebra::Vector3;

use crate::laws::InStreams;
use crate::{Family, Follows, Form, Hook, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "tool-compliance",
    meaning: "the handle or the cable's hook gives way to the force",
    inspect: "the connector between the last link and the cable",
    adds: "c F",
    source: "D7, C14",
    hook: Hook::Structure,
    form: Form::ToolSpring,
    needs: &[Need::Chain, Need::Force],
    parameters: &[Parameter::size("m_per_n", 0.0, 2e-3)],
    follows: Follows::Force,
    is_positive: true,
    ..Spec::of(Family::Tool)
};

pub(crate) const LAW: InStreams = InStreams(|input| {
    let force = input.context.force_n.as_ref()?;
    let moved = |row: usize| (force[row], Vector3::zeros());
    Some(vec![input.context.handle(moved)])
});
