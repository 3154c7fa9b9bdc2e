//! The reading grows with the square of the angle at which the cable leaves its guide.

use crate::cable::EXIT;
use crate::laws::Linear;
use crate::{Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-twist",
    meaning: "the reading changes with the cable's angle to its straight direction",
    inspect: "the guide and the fastening of the cable",
    adds: "c phi^2",
    source: "C4",
    parameters: &[Parameter::size("twist_m_per_rad2", 0.0, 0.02)],
    ..EXIT
};

pub(crate) const LAW: Linear = Linear(|input| {
    let cable = input.context.cable.as_ref()?;
    let squares = (0..input.context.rows()).map(|row| cable.exit_angle_rad(row).powi(2));
    Some(vec![squares.collect()])
});
