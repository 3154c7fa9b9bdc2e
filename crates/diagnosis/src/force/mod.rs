//! Effects on torques and forces (E1 to E10): what inverse dynamics and the hand's force leave of
//! the drives' torques.
//!
//! docs/diagnosis-force.md derives the model. The torques are of use only where they are recorded
//! with time, and the test says nothing of positions: errors of angles and lengths are allowed for
//! as what is not exactly known.

mod along;
pub(crate) mod answer;
pub(crate) mod asked;
mod assumed;
mod base;
mod changes;
mod effects;
mod gravity;
mod grip;
mod partial;
mod posture;
pub(crate) mod recorded;
mod rows;
mod select;
#[cfg(test)]
mod tests;
mod trust;

use haptical_effects::Context;
use haptical_model::Recording;

use self::along::Along;
use self::answer::ForceAnswer;
pub(crate) use self::answer::names::names;
use self::base::Base;
use self::changes::carried::Carried;
use self::changes::second::Model;
pub(crate) use self::changes::second::{OnSecond, not_predicted};
use self::effects::Effects;
use self::recorded::{Besides, Recorded, may_be_held};
use self::rows::fast;
use crate::DiagnosisError;

/// Tests the recorded torques and forces for effects of their own, with some of them left out of
/// the catalogue.
///
/// # Errors
/// [`DiagnosisError`] for a statistic that is not a number.
pub(crate) fn examine(
    context: &Context<'_>,
    without: &[String],
) -> Result<ForceAnswer, DiagnosisError> {
    Ok(examine_both(context, None, without)?.0)
}

/// The same, with what the model of the torques leaves of a second recording. A hand on the handle that nobody measures leaves its
/// forces in the torques: where these are explained without one, nobody held the arm (docs/assumptions.md, A305).
///
/// # Errors
/// As [`examine`]; a row of the second recording at which the device has no value.
pub(crate) fn examine_both(
    context: &Context<'_>,
    second: Option<&Recording>,
    without: &[String],
) -> Result<Examined, DiagnosisError> {
    let free = examined(
        Recorded::held_by_nobody(context),
        context,
        (second, without),
    )?;
    if !may_be_held(context) || free.0.is_explained() {
        return Ok(free);
    }
    let held = examined(Recorded::new(context), context, (second, without))?;
    let is_by_hand = free.0.significant && !held.0.significant && held.0.findings.is_empty();
    Ok(match is_by_hand {
        true => (free.0.caused_by_hand(held.0), held.1),
        false => held,
    })
}

/// What the torques say, and what is left of those of a second recording.
type Examined = (ForceAnswer, Option<OnSecond>);

fn examined<'a>(
    recorded: Result<Recorded<'a>, String>,
    context: &'a Context<'a>,
    (second, without): (Option<&Recording>, &[String]),
) -> Result<Examined, DiagnosisError> {
    let none = |answer: ForceAnswer| Ok((answer, None));
    let has_torques =
        (0..context.device.joints.len()).any(|joint| context.torque_stream(joint).is_some());
    let recorded = match recorded {
        Ok(recorded) => recorded,
        Err(why) => return none(ForceAnswer::untestable(&why, has_torques)),
    };
    let mut along = Along::new(&recorded)?;
    let Some((mut base, carried)) = base_of(&mut along, without) else {
        let why = "the torques have no noise at all";
        return none(ForceAnswer::untestable(why, has_torques));
    };
    let effects = Effects::new(&along, without);
    let selection = effects.select(&mut base)?;
    let model = Model {
        effects: &effects,
        base: &base,
        selection: &selection,
        carried: &carried,
    };
    let seen = second.map(|second| model.on_second(second)).transpose()?;
    Ok((answer::answer(&effects, &base, &selection, &carried)?, seen))
}

/// The base model without what the arm carries in some runs alone; none where the torques have no noise at all.
fn base_of(along: &mut Along<'_>, without: &[String]) -> Option<(Base, Carried)> {
    let whitener = along.whitener(Besides::Nothing)?;
    let mut base = along.fit(&whitener, Besides::Nothing);
    let carried = Carried::new(along, &base, without);
    if let Some(torque_nm) = carried.torque_nm() {
        along.put_down(torque_nm);
        base = along.fit(&whitener, Besides::Nothing);
    }
    let fitted = carried.on(&along.less(&base.rest()));
    base.append(fast::rows(along, &fitted));
    Some((base, carried))
}
