//! Friction that is another in each direction.

use std::rc::Rc;

use crate::effect::{Candidate, Context, Effect};
use crate::thresholds::effect::FRICTION_LAW_SD;

pub(in crate::effect) const EFFECT: Effect =
    Effect::new("friction-asymmetry", candidates).of_own_joint();

/// `|s(dq)|` and `|dq|`: half the difference of Coulomb and of viscous friction between the directions. The first alone is an offset
/// wherever the joint moves.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    context.at_joints(|joint| {
        let coulomb = context.sign(joint).iter().map(|own| own.abs()).collect();
        let viscous = context.speed(joint).iter().map(|own| own.abs()).collect();
        let numbers = |own: &[f64]| vec![("coulomb_nm", own[0]), ("viscous_nm_s_per_rad", own[1])];
        let found = context.of_signals(EFFECT.name, joint, &[coulomb, viscous], Rc::new(numbers));
        let found = found.map(|own| own.about_to(FRICTION_LAW_SD));
        found.into_iter().collect()
    })
}
