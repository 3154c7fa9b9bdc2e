//! A second round of the diagnosis, from the base model that the causes of the first one leave.

use std::cell::OnceCell;

use haptical_effects::Context;
use haptical_model::Recording;

use crate::Result;
use crate::engine::{Base, Cause, Fitting, Model, Prepared, root_mean_square, with_causes};
use crate::noise::KnownNoise;
use crate::select::Selection;
use crate::thresholds::fit::{MOVED_FAR, NEARER_ROUNDS, NOISE_FELL, STILL_NOISES};

/// A second round from what is known with the causes: the gap pushed the base model from where it belongs, and the effects'
/// geometry with it, or its fast parts passed for noise.
pub(crate) struct Again<'r> {
    /// With the causes in the model, where it fell.
    pub(crate) noise: Option<KnownNoise>,
    pub(crate) there: There<'r>,
}

/// A base model that causes leave, and the log at it.
pub(crate) struct There<'r> {
    base: &'r Base,
    context: Context<'r>,
}

/// Places of the base models that refits with causes leave in turn.
pub(crate) type Bases = [OnceCell<Base>; NEARER_ROUNDS + 1];

impl<'r> Again<'r> {
    pub(crate) fn new(selection: &Selection<'r>, bases: &'r Bases) -> Result<Option<Self>> {
        if selection.causes().is_empty() {
            return Ok(None);
        }
        let engine = selection.engine();
        let noise = engine.noise_of(&selection.refit.residual);
        let mut pairs = engine.noise.iter().zip(&noise.noise);
        let fell = pairs.any(|(before, after)| after.ratio < NOISE_FELL * before.ratio);
        let model = &selection.refit.model;
        let is_far = engine.moved(&model.bare) >= MOVED_FAR;
        let base = bases[0].get_or_init(|| Base {
            device: engine.problem.device_with(&model.values),
            ..engine.base.clone()
        });
        let at = (base, engine.context.recording);
        let (has_moved, context) = moved(selection, &engine.context, at, &model.causes)?;
        Ok((fell || is_far || has_moved).then(|| Self {
            noise: fell.then_some(noise),
            there: There { base, context },
        }))
    }
}

/// The base model that causes leave, with what they add worked out where it is: refitted in turn until that moves no more.
pub(crate) fn nearer<'r>(
    selection: &Selection<'_>,
    mut there: There<'r>,
    (recording, postures): (&'r Recording, &'r Recording),
    bases: &'r Bases,
) -> Result<(&'r Base, Model)> {
    let engine = selection.engine();
    let mut model = selection.refit.model.clone();
    for place in &bases[1..] {
        let There { base, context } = there;
        let mut prepared = Prepared::of_context(base, recording, postures, context)?;
        prepared.context.lines.clone_from(&engine.context.lines);
        let fitting = Fitting {
            data: &prepared,
            effects: selection.selector.effects,
            part: &engine.whole,
            least_fall: None,
        };
        let fitted = fitting.descend(&model)?;
        if !fitted.has_converged() {
            return Ok((base, model));
        }
        model = fitted.model;
        let base = place.get_or_init(|| Base {
            device: prepared.problem.device_with(&model.values),
            ..base.clone()
        });
        let at = (base, postures);
        let (has_moved, context) = moved(selection, &prepared.context, at, &model.causes)?;
        there = There { base, context };
        if !has_moved {
            break;
        }
    }
    Ok((there.base, model))
}

/// Whether what the causes add is more than a tenth of a stream's noise away from what they add to the base model that they leave: a
/// device file of both would not leave what the fit does; and the log at that model.
fn moved<'r>(
    selection: &Selection<'_>,
    here: &Context<'_>,
    (base, postures): (&'r Base, &'r Recording),
    causes: &[Cause],
) -> Result<(bool, Context<'r>)> {
    let (engine, effects) = (selection.engine(), selection.selector.effects);
    let mut there = Context::new(&base.device, postures, &here.streams)?;
    there.lines.clone_from(&here.lines);
    let nothing = vec![vec![0.0; here.recording.len()]; here.streams.len()];
    let [before, after] =
        [here, &there].map(|at| with_causes(nothing.clone(), at, effects, causes));
    let differ = |stream: usize| {
        let changes = before[stream].iter().zip(&after[stream]);
        let used = changes
            .zip(&engine.usable[stream])
            .filter(|(_, usable)| **usable);
        let changes: Vec<f64> = used.map(|((before, after), _)| before - after).collect();
        root_mean_square(&changes) > STILL_NOISES * engine.floor[stream]
    };
    let has_moved = (0..before.len()).any(differ);
    Ok((has_moved, there))
}
