//! A ratio error of a joint for which the base model has none, or the pitch of a screw.

use crate::laws::Linear;
use crate::{Absorbed, Family, Follows, Form, Hook, Need, Parameter, Spec};

/// The transmission ratio is not the nominal one.
pub const SPEC: Spec = Spec {
    name: "ratio-error",
    meaning: "the transmission ratio is not the nominal one",
    inspect: "the diameters of the drums, the cable's thickness included",
    adds: "-R_e theta / R",
    source: "D4",
    hook: Hook::Transmission,
    form: Form::Scale,
    needs: &[Need::Chain],
    parameters: &[Parameter::size("ratio_deviation", 0.0, 0.2)],
    follows: Follows::Angle,
    absorbed_by: Absorbed::ByTransmission,
    ..Spec::of(Family::Shape)
};

pub(crate) const LAW: Linear = Linear(|input| {
    // output = reading / (1 + deviation / ratio), as eq. (1)
    let ratio = input.joint()?.transmission_ratio;
    let readings = input.reading()?.iter();
    Some(vec![readings.map(|q| -q / ratio).collect()])
});
