//! Effects on torques and forces (E1 to E10): what inverse dynamics and the hand's force leave of
//! the drives' torques.
//!
//! docs/diagnosis-force.md derives the model. The torques are of use only where they are recorded
//! with time, and the test says nothing of positions: errors of angles and lengths are allowed for
//! as what is not exactly known.

mod along;
pub(crate) mod answer;
mod base;
mod effects;
mod gaps;
mod gravity;
mod grip;
mod posture;
mod recorded;
mod rows;
mod select;
#[cfg(test)]
mod tests;
mod trust;
mod values;

use haptical_effects::{Context, spec};

use self::along::Along;
use self::answer::ForceAnswer;
use self::effects::Effects;
use self::recorded::{Besides, Recorded};
use self::rows::fast;
use crate::DiagnosisError;

/// Names of the effects on torques and forces.
fn names() -> impl Iterator<Item = &'static str> {
    let is_on_drives = |name: &&str| spec(name).is_some_and(|spec| spec.hook.is_on_drives());
    haptical_effects::names().into_iter().filter(is_on_drives)
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
        (0..context.device.joints.len()).any(|joint| context.torque_stream(joint).is_some());
    let recorded = match Recorded::new(context) {
        Ok(recorded) => recorded,
        Err(why) => return Ok(ForceAnswer::untestable(&why, has_torques)),
    };
    let along = Along::new(&recorded);
    let Some(whitener) = along.whitener(Besides::Nothing) else {
        let why = "the torques have no noise at all";
        return Ok(ForceAnswer::untestable(why, has_torques));
    };
    let mut base = along.fit(&whitener, Besides::Nothing);
    let fitted_before = along.less(&base.rest());
    base.append(fast::rows(&along, &fitted_before));
    let effects = Effects::new(&along, without);
    let selection = effects.select(&mut base)?;
    answer::answer(&effects, &base, &selection, &fitted_before)
}
