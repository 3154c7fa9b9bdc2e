//! The mount of the robot turns against the cable encoder by C M, M the moment of hand and weights about the base.

use crate::laws::InStreams;
use crate::{Family, Follows, Form, Hook, Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "base-compliance",
    meaning: "the base tilts with the load",
    inspect: "screws and table under the device",
    adds: "see above",
    source: "D6",
    hook: Hook::Structure,
    form: Form::BaseSpring,
    needs: &[Need::Chain, Need::BaseMoment],
    parameters: &[Parameter::size("rad_per_nm", 0.0, 1e-2)],
    follows: Follows::Force,
    is_positive: true,
    ..Spec::of(Family::Load)
};

pub(crate) const LAW: InStreams = InStreams(|input| {
    let context = input.context;
    let moment = context.base_moment_nm.as_ref()?;
    let turned = |row: usize| (moment[row].cross(&context.way_from_base(row)), moment[row]);
    Some(vec![context.handle(turned)])
});
