//! Effects that an earlier model has, with other sizes: a play that has grown (docs/diagnosis.md, "Earlier model").

use std::collections::BTreeMap;

use haptical_effects::device::{OwnEffect, effects_of, with_variances};
use haptical_effects::{Context, Hook, Role};
use haptical_model::{Device, ParameterId};
use nalgebra::DMatrix;

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::thresholds::earlier_model::GROWN_SD;

/// An effect of the device whose size is another one than the earlier model's.
#[derive(Debug)]
pub(crate) struct Resized {
    pub(crate) name: &'static str,
    /// From 0.
    pub(crate) joint: Option<usize>,
    /// Among the free columns.
    pub(crate) columns: Vec<usize>,
    /// Whether it enters in front of the external encoder.
    pub(crate) in_drive: bool,
    pub(crate) parameters: BTreeMap<String, ParameterAnswer>,
    /// The numbers of the earlier model.
    pub(crate) earlier: BTreeMap<String, f64>,
}

/// The effects of the device whose fitted amplitude differs from the earlier model's by more than the fit and the law may get
/// wrong; `deviations` are those of the free columns.
pub(crate) fn resized(engine: &Engine<'_>, model: &Device, deviations: &[f64]) -> Vec<Resized> {
    let device = &engine.base.device;
    let (Ok(own), Ok(earlier)) = (effects_of(device), effects_of(model)) else {
        return Vec::new();
    };
    let is_same = |one: &OwnEffect, other: &OwnEffect| {
        one.effect.spec() == other.effect.spec()
            && one.effect.joint() == other.effect.joint()
            && one.effect.other_joint() == other.effect.other_joint()
    };
    let changed = own.iter().filter_map(|own| {
        let before = earlier.iter().find(|earlier| is_same(own, earlier))?;
        change(engine, (own, before), deviations)
    });
    changed.collect()
}

fn change(
    engine: &Engine<'_>,
    (own, before): (&OwnEffect, &OwnEffect),
    deviations: &[f64],
) -> Option<Resized> {
    let context: &Context<'_> = &engine.context;
    let (effect, spec) = (own.effect.as_ref(), own.effect.spec());
    let (earlier, earlier_shape) = before.amplitudes(context);
    let (mut amplitudes, shape) = own.amplitudes(context);
    let mut columns = Vec::new();
    let mut variances = vec![0.0; amplitudes.len()];
    let mut has_changed = false;
    for (column, &position) in engine.base.free.iter().enumerate() {
        let ParameterId::Effect {
            effect: index,
            number,
        } = engine.base.parameters[position]
        else {
            continue;
        };
        if index != own.index || number >= amplitudes.len() {
            continue;
        }
        let (value, sd) = (engine.start.model.values[position], deviations[column]);
        let size = value.abs().max(earlier[number].abs());
        let wrong = sd.hypot(spec.law_error.amplitude * size);
        has_changed |= (value - earlier[number]).abs() > GROWN_SD * wrong;
        amplitudes[number] = value;
        variances[number] = sd * sd;
        columns.push(column);
    }
    if !has_changed || !effect.is_possible(context, &amplitudes) {
        return None;
    }
    let covariance = DMatrix::from_fn(amplitudes.len(), amplitudes.len(), |a, b| {
        if a == b { variances[a] } else { 0.0 }
    });
    let found = with_variances(effect, context, &amplitudes, shape, &covariance);
    let numbers = before.effect.values(context, &earlier, earlier_shape);
    let mut parameters = BTreeMap::new();
    let mut earlier = BTreeMap::new();
    for ((parameter, (value, variance)), before) in spec.parameters.iter().zip(found).zip(numbers) {
        let relative = match parameters.is_empty() {
            true => effect
                .scale_uncertainty(context)
                .hypot(spec.law_error.amplitude),
            false => 0.0,
        };
        let answer = ParameterAnswer::normal(value, variance.max(0.0).sqrt());
        parameters.insert(parameter.name.to_owned(), answer.off_by_a_factor(relative));
        if matches!(parameter.role, Role::Size | Role::Inverse) && before.is_finite() {
            earlier.insert(parameter.name.to_owned(), before);
        }
    }
    Some(Resized {
        name: spec.name,
        joint: effect.joint(),
        columns,
        in_drive: spec.hook == Hook::Transmission,
        parameters,
        earlier,
    })
}
