//! The numbers of the base model by name and place, as an earlier model has them, and effects that it has with other sizes.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::mem::discriminant;

use haptical_effects::base_model::{JOINT_OFFSET, LINK_GEOMETRY, PARALLELOGRAM_ERROR};
use haptical_effects::device::{OwnEffect, effects_of, with_variances};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_effects::transmission::{DRUM_ECCENTRICITY, RATIO_ERROR};
use haptical_effects::{Context, Hook, Role};
use haptical_model::kinematics::Parameter;
use haptical_model::{
    Device, JointType, ParameterId, SurroundingParameter, TransmissionError, TransmissionKind,
};
use nalgebra::DMatrix;

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::thresholds::earlier_model::{BEYOND_CHANCE, GROWN_SD, TWO_FITS};

/// Free columns of what was touched.
pub(super) fn places(engine: &Engine<'_>) -> Vec<usize> {
    let free = engine.base.free.iter().enumerate();
    free.filter(|(_, position)| {
        matches!(
            engine.base.parameters[**position],
            ParameterId::Surrounding(
                SurroundingParameter::Contact { .. } | SurroundingParameter::Plane { .. }
            )
        )
    })
    .map(|(column, _)| column)
    .collect()
}

/// Squared standard deviations that chance and the earlier model's own errors give a group.
pub(super) fn chance(rank: usize) -> f64 {
    let rank = rank as f64;
    TWO_FITS * (rank + BEYOND_CHANCE * rank.sqrt())
}

/// Parameters that belong to one name at one place.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) name: &'static str,
    pub(super) joint: Option<usize>,
    /// Among the free columns.
    pub(super) columns: Vec<usize>,
    pub(super) in_drive: bool,
    /// Of an effect of the device.
    pub(super) resized: Option<Resized>,
}

/// The free numbers by name and place, and the device's own effects that have other sizes.
pub(super) fn groups(engine: &Engine<'_>, resized: Vec<Resized>) -> Vec<Group> {
    let device = engine.context.device;
    let own = resized.into_iter().map(|own| Group {
        name: own.name,
        joint: own.joint,
        columns: own.columns.clone(),
        in_drive: own.in_drive,
        resized: Some(own),
    });
    let mut groups: Vec<Group> = own.collect();
    for (column, &position) in engine.base.free.iter().enumerate() {
        let (name, joint, in_drive) = match engine.base.parameters[position] {
            ParameterId::Link { row, parameter } => {
                let joint = row.checked_sub(1);
                match joint.is_some_and(|joint| zero_of(device, joint) == Some(parameter)) {
                    true => (JOINT_OFFSET.name, joint, false),
                    false => (LINK_GEOMETRY.name, joint, false),
                }
            }
            ParameterId::Compliance { joint } => (JOINT_COMPLIANCE.name, Some(joint), false),
            // the place of a rig is no effect of the device, and an effect of its own size is no deviation from it
            ParameterId::Surrounding(_) | ParameterId::Effect { .. } => continue,
            ParameterId::Transmission { joint, index } => {
                (term_name(device, joint, index), Some(joint), true)
            }
        };
        match groups.iter_mut().find(|group| {
            let is_place = group.joint == joint && group.in_drive == in_drive;
            group.resized.is_none() && group.name == name && is_place
        }) {
            Some(group) => group.columns.push(column),
            None => groups.push(Group {
                name,
                joint,
                columns: vec![column],
                in_drive,
                resized: None,
            }),
        }
    }
    groups
}

/// Which number of its own row is a joint's zero.
pub(super) fn zero_of(device: &Device, joint: usize) -> Option<Parameter> {
    let joint = device.joints.get(joint)?;
    Some(match joint.joint_type {
        JointType::Revolute => Parameter::Theta,
        JointType::Prismatic => Parameter::D,
    })
}

/// Whether a name is that of a joint's zero.
pub(super) fn is_zero(name: &str) -> bool {
    name == JOINT_OFFSET.name
}

/// The name of a number of a joint's drive.
pub(super) fn term_name(device: &Device, joint: usize, index: usize) -> &'static str {
    match (device.joints[joint].transmission, index) {
        (TransmissionKind::Parallelogram, _) => PARALLELOGRAM_ERROR.name,
        (_, 0) => JOINT_OFFSET.name,
        (_, 1) => RATIO_ERROR.name,
        _ => DRUM_ECCENTRICITY.name,
    }
}

/// A number of the base model as the earlier model has it. A polynomial of another degree or range is taken at this one's
/// Chebyshev points (Trefethen 2019, chapter 4); none where the earlier model has another law.
pub(crate) fn earlier_value(
    parameter: ParameterId,
    model: &Device,
    device: &Device,
) -> Option<f64> {
    let (joint, index) = match parameter {
        ParameterId::Transmission { joint, index } => (joint, index),
        // the model may have other effects, or none
        ParameterId::Effect { .. } => return None,
        _ => return Some(parameter.value(model)),
    };
    let (earlier, own) = (
        &model.joints[joint],
        &device.joints[joint].transmission_error,
    );
    let TransmissionError::Chebyshev {
        range_rad: [low, high],
        coefficients,
    } = own
    else {
        let is_same = discriminant(own) == discriminant(&earlier.transmission_error);
        return is_same.then(|| parameter.value(model));
    };
    let count = coefficients.len() as f64;
    let mut sum = 0.0;
    for point in 0..coefficients.len() {
        let angle = PI * (point as f64 + 0.5) / count;
        let reading_rad = 0.5 * (low + high) + 0.5 * (high - low) * angle.cos();
        sum += earlier.error_rad(reading_rad).ok()? * (index as f64 * angle).cos();
    }
    Some(sum * if index == 0 { 1.0 } else { 2.0 } / count)
}

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
