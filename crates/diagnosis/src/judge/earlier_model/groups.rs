//! The numbers of the base model by name and place.

use haptical_effects::base_model::{JOINT_OFFSET, LINK_GEOMETRY, PARALLELOGRAM_ERROR};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_effects::transmission::{DRUM_ECCENTRICITY, RATIO_ERROR};
use haptical_model::kinematics::Parameter;
use haptical_model::{
    Device, JointType, ParameterId, SurroundingParameter, TransmissionError, TransmissionKind,
};

use super::resized::Resized;
use crate::engine::Engine;
use crate::thresholds::earlier_model::{BEYOND_CHANCE, TWO_FITS};

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
    let is_capstan = matches!(
        device.joints[joint].transmission_error,
        TransmissionError::Capstan(_)
    );
    match (device.joints[joint].transmission, is_capstan, index) {
        (TransmissionKind::Parallelogram, _, _) => PARALLELOGRAM_ERROR.name,
        (_, _, 0) => JOINT_OFFSET.name,
        (_, true, 1) => RATIO_ERROR.name,
        (_, true, _) => DRUM_ECCENTRICITY.name,
        (_, false, 1) => RATIO_ERROR.name,
        (_, false, _) => DRUM_ECCENTRICITY.name,
    }
}
