//! Start values of effects that a calibration is to fit: by the refit of a diagnosis.

use haptical_calibration::LossChoice;
use haptical_effects::Effect;
use haptical_effects::device::{bare, effects_of, entry};
use haptical_identification::Interrupt;
use haptical_model::{Device, Recording};

use crate::DiagnosisError;
use crate::engine::{Base, Cause, Prepared, Refit};
use crate::thresholds::engine::BETTER_SHAPE;

/// The device with numbers for those of its effects that are to be fitted and have none: base model and effects are fitted
/// together, a law with a shape from each shape of its grid. An effect of which the recording shows nothing gets none.
///
/// # Errors
/// [`DiagnosisError`].
pub fn start_values(
    device: &Device,
    recording: &Recording,
    loss: LossChoice,
) -> Result<Device, DiagnosisError> {
    let own = effects_of(device)?;
    if own.iter().all(|effect| effect.values.is_some()) {
        return Ok(device.clone());
    }
    let rigid = bare(device);
    let base = Base::fit(&rigid, recording, loss, &Interrupt::default())?;
    let prepared = Prepared::new(&base, recording, recording)?;
    let gone = prepared.outlying();
    let cleaned = crate::noise::without_readings(recording, &gone);
    let engine = prepared.without(&gone, &cleaned).fit(None)?;
    let mut indices = Vec::new();
    let mut wanted = Vec::new();
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    let mut refit = engine.start.clone();
    for own in own {
        let is_on_drives = own.effect.spec().hook.is_on_drives();
        if is_on_drives || own.effect.untestable(&engine.context).is_some() {
            continue;
        }
        let (amplitudes, shape) = own.amplitudes(&engine.context);
        indices.push(own.index);
        wanted.push(own.values.is_none());
        effects.push(own.effect);
        refit.model.causes.push(Cause {
            effect: effects.len() - 1,
            amplitudes,
            shape,
            times: Vec::new(),
        });
    }
    for place in (0..effects.len()).filter(|&place| wanted[place]) {
        let mut best: Option<Refit> = None;
        for shape in effects[place].shapes(&engine.context) {
            let mut model = refit.model.clone();
            model.causes[place].shape = shape;
            let Ok(fitted) = engine.refit(&effects, &model) else {
                continue;
            };
            // the first shape is the plainest: another one must be better beyond chance
            let is_better = best
                .as_ref()
                .is_none_or(|best| engine.cost(&fitted) + BETTER_SHAPE < engine.cost(best));
            if is_better {
                best = Some(fitted);
            }
        }
        refit = best.unwrap_or(refit);
    }
    let mut device = device.clone();
    for (place, (&index, effect)) in indices.iter().zip(&effects).enumerate() {
        let cause = &refit.model.causes[place];
        let is_there = cause.amplitudes.iter().any(|amplitude| *amplitude != 0.0)
            && effect.is_possible(&engine.context, &cause.amplitudes);
        if wanted[place] && is_there {
            let (amplitudes, shape) = (&cause.amplitudes, cause.shape);
            let found = entry(effect.as_ref(), &engine.context, amplitudes, shape);
            device.effects[index].numbers = found.numbers;
        }
    }
    Ok(device)
}
