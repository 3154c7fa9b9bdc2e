//! Chosen effects as findings, with their numbers.

use std::collections::BTreeMap;

use haptical_effects::force::{GRIP_FORCE, UNBALANCED_GRAVITY};
use haptical_effects::{Effect, Spec};

use super::values::Sizes;
use crate::answer::{CauseAnswer, IN_NO_CATALOGUE, ParameterAnswer};
use crate::force::gravity::Unbalanced;
use crate::force::grip::Grip;
use crate::force::select::Pick;
use crate::thresholds::torque::{GRIP_PROBABILITY, LISTED_PROBABILITY};

/// A plausible name with its numbers, and with the probability that it is one of the catalogue's at all.
fn finding(
    spec: &Spec,
    joint: Option<usize>,
    probability: f64,
    share: f64,
    parameters: BTreeMap<String, ParameterAnswer>,
) -> CauseAnswer {
    CauseAnswer {
        parameters,
        share,
        ..CauseAnswer::named(spec.name, joint, LISTED_PROBABILITY * probability)
    }
}

pub(super) fn of_pick(
    effect: &dyn Effect,
    sizes: &Sizes<'_, '_, '_>,
    pick: &Pick,
    share: f64,
) -> CauseAnswer {
    let (parameters, plausible) = sizes.parameters(pick);
    let (joint, probability) = (effect.joint(), pick.probability);
    CauseAnswer {
        confusable_with: pick.rivals.iter().map(|&name| name.to_owned()).collect(),
        plausible,
        implausible: !plausible,
        ..finding(effect.spec(), joint, probability, share, parameters)
    }
}

pub(super) fn of_grip(grip: &Grip) -> CauseAnswer {
    let spec = &GRIP_FORCE.parameters[0];
    let mut force_n = ParameterAnswer::normal(grip.force_n, grip.force_sd_n);
    force_n.ci95[0] = force_n.ci95[0].max(0.0);
    let parameters = BTreeMap::from([(spec.name.to_owned(), force_n)]);
    let plausible = spec.is_plausible(grip.force_n, 1.0);
    CauseAnswer {
        confusable_with: vec![IN_NO_CATALOGUE.to_owned()],
        plausible,
        implausible: !plausible,
        ..finding(
            &GRIP_FORCE,
            None,
            GRIP_PROBABILITY,
            1.0 - grip.left,
            parameters,
        )
    }
}

/// `total`: structured energy of the rest, 0 where it is hardly any.
pub(super) fn of_gravity(found: &Unbalanced, total: f64) -> CauseAnswer {
    let numbers = [
        Some((found.moment_nm, found.moment_sd_nm)),
        Some((found.deviations, 0.0)),
        found.mass_kg,
    ];
    let specs = UNBALANCED_GRAVITY.parameters.iter().zip(numbers);
    let parameters = specs.filter_map(|(spec, number)| {
        let (value, sd) = number?;
        Some((spec.name.to_owned(), ParameterAnswer::normal(value, sd)))
    });
    let square = found.deviations * found.deviations;
    let (joint, share) = (Some(found.joint), square / (square + total));
    finding(
        &UNBALANCED_GRAVITY,
        joint,
        found.probability,
        share,
        parameters.collect(),
    )
}
