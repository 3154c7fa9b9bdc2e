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
mod fast;
mod gravity;
mod grip;
mod harmonics;
mod partial;
mod posture;
mod recorded;
mod rows;
mod second;
mod select;
#[cfg(test)]
mod tests;

use haptical_effects::Context;
use haptical_model::Recording;

use self::along::Along;
use self::answer::ForceAnswer;
pub(crate) use self::answer::names;
use self::base::Base;
use self::changes::Carried;
use self::effects::Effects;
use self::recorded::{Besides, Recorded, may_be_held};
use self::select::Selection;
use crate::Result;

/// Means over blocks: a row for each block, a column for each channel.
type Means = nalgebra::DMatrix<f64>;

/// Tests the recorded torques and forces for effects of their own, with some of them left out of the catalogue, and what the model of the
/// torques leaves of a second recording. A hand on the handle that nobody measures leaves its forces in the torques: where these are
/// explained without one, nobody held the arm (docs/assumptions.md, A305).
pub(crate) fn examine(
    context: &Context<'_>,
    second: Option<&Recording>,
    without: &[String],
) -> Result<ForceAnswer> {
    let free = examined(context, false, (second, without))?;
    if !may_be_held(context) || free.is_explained() {
        return Ok(free);
    }
    let held = examined(context, true, (second, without))?;
    let is_by_hand = free.significant && !held.significant && held.findings.is_empty();
    Ok(match is_by_hand {
        true => free.caused_by_hand(held),
        false => held,
    })
}

fn examined(
    context: &Context<'_>,
    is_held: bool,
    (second, without): (Option<&Recording>, &[String]),
) -> Result<ForceAnswer> {
    let mut model = match Model::new(context, is_held, without)? {
        Ok(model) => model,
        Err(why) => {
            let mut joints = 0..context.device.joints.len();
            let has_torques = joints.any(|joint| context.torque_stream(joint).is_some());
            return Ok(ForceAnswer::untestable(&why, has_torques));
        }
    };
    model.selection = model.effects.select(&mut model.base)?;
    let second = second.map(|second| model.on_second(second)).transpose()?;
    Ok(ForceAnswer {
        second,
        ..model.answer()?
    })
}

/// The torques of a recording, and what explains them.
struct Model<'a> {
    effects: Effects<'a>,
    /// The base model with the effects that were picked.
    base: Base,
    selection: Selection,
    carried: Carried,
}

impl<'a> Model<'a> {
    /// Fits the base model without what the arm carries only in some runs. The inner error says why nothing can be
    /// said.
    fn new(
        context: &'a Context<'a>,
        is_held: bool,
        without: &'a [String],
    ) -> Result<Result<Self, String>> {
        let mut along = match Recorded::new(context, is_held) {
            Ok(recorded) => Along::new(recorded)?,
            Err(why) => return Ok(Err(why)),
        };
        let why = "the torques have no noise at all";
        let Some(mut base) = along.fit(Besides::Nothing) else {
            return Ok(Err(why.to_owned()));
        };
        let carried = Carried::new(&along, &base, without);
        if !carried.payloads.is_empty() {
            along.reading -= &carried.torque_nm;
            base = along.fit(Besides::Nothing).unwrap_or(base);
        }
        let fitted = &along.reading - base.rest() + &carried.torque_nm;
        base.append(fast::rows(&along, &fitted));
        Ok(Ok(Self {
            effects: Effects::new(along, without),
            base,
            selection: Selection::default(),
            carried,
        }))
    }
}
