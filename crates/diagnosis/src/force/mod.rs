//! Effects on torques and forces (E1 to E10): what inverse dynamics and the hand's force leave of
//! the drives' torques.
//!
//! docs/diagnosis-force.md derives the model. The torques are of use only where they are recorded
//! with time, and the test says nothing of positions: errors of angles and lengths are allowed for
//! as what is not exactly known.

mod along;
pub(crate) mod answer;
mod base;
mod columns;
mod effects;
mod energy;
mod fast;
mod gaps;
mod gravity;
mod grip;
mod normal;
mod posture;
mod recorded;
mod score;
mod select;
#[cfg(test)]
mod tests;
mod trust;
mod values;
mod weights;

use haptical_effects::{Context, Hook, Spec};

use self::along::Along;
use self::answer::ForceAnswer;
use self::effects::Effects;
use self::recorded::{Besides, Recorded};
use self::select::Selector;
use crate::DiagnosisError;

/// Names of the effects on torques and forces.
fn names() -> impl Iterator<Item = &'static str> {
    let is_force = |spec: &&Spec| matches!(spec.hook, Hook::Torque | Hook::ForceSensor);
    haptical_effects::specs()
        .filter(is_force)
        .map(|spec| spec.name)
}

/// Tests the recorded torques and forces for effects of their own, with some of them left out of
/// the catalogue.
///
/// # Errors
/// [`DiagnosisError`] for a statistic that is not a number.
pub(crate) fn examine(
    context: &Context<'_>,
    without: &[String],
) -> Result<ForceAnswer, DiagnosisError> {
    let has_torques =
        (0..context.device.joints.len()).any(|joint| recorded::column(context, joint).is_some());
    let recorded = match Recorded::new(context) {
        Ok(recorded) => recorded,
        Err(why) => return Ok(ForceAnswer::untestable(&why, has_torques)),
    };
    let along = Along::new(&recorded);
    let Some(weights) = along.weights(Besides::Nothing) else {
        let why = "the torques have no noise at all";
        return Ok(ForceAnswer::untestable(why, has_torques));
    };
    let mut base = along.fit(&weights, Besides::Nothing);
    base.normal.fast = fast::table(&along, &base.normal.fitted());
    let effects = Effects::new(&along, base.scales, without);
    let selector = Selector::new(&recorded, &weights, &effects, &along.reading);
    let fitted_before = base.normal.fitted();
    let selection = selector.select(&mut base)?;
    answer::answer(&selector, &base, &selection, &fitted_before)
}
