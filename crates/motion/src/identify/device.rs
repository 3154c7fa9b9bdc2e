//! A device with the dynamics that were identified.

use std::collections::BTreeMap;

use haptical_model::{Device, DeviceEffect, JointType, ModelError};

use crate::identify::friction::FrictionLaw;
use crate::identify::result::{Dynamics, Estimated, JointDynamics};

/// Name of a device's friction in the catalogue of effects.
const FRICTION: &str = "joint-friction";

/// The device with identified masses, armatures, friction, offsets and delay in the place of its own.
///
/// Friction is a `joint-friction` of its file; one that the log does not tell from none is left out. Of one that grows with the load the file
/// gets that of the mean load.
///
/// # Errors
/// [`ModelError`] for another device than the one that was identified.
pub fn with_dynamics(device: &Device, found: &Dynamics) -> Result<Device, ModelError> {
    let mut device = device.clone();
    for body in found.bodies.iter().filter(|own| !own.is_held) {
        device.set_row_inertia(body.row, &body.inertia)?;
    }
    device.effects.retain(|own| own.name != FRICTION);
    for own in &found.joints {
        let Some(joint) = device.joints.get_mut(own.joint) else {
            continue;
        };
        joint.armature_kgm2 = Some(own.armature.value.max(0.0));
        joint.torque_offset_nm = Some(own.offset.value);
        joint.torque_delay_s = found.delay_s.is_told().then_some(found.delay_s.value);
        let slides = joint.joint_type == JointType::Prismatic;
        device.effects.extend(friction(own, slides));
    }
    Ok(device)
}

fn friction(own: &JointDynamics, slides: bool) -> Option<DeviceEffect> {
    let [coulomb, viscous] = match slides {
        true => ["coulomb_n", "viscous_n_s_per_m"],
        false => ["coulomb_nm", "viscous_nm_s_per_rad"],
    };
    let (transition, size) = match (own.law, slides) {
        (FrictionLaw::Speed(size), true) => ("transition_m_per_s", size),
        (FrictionLaw::Speed(size), false) => ("transition_rad_per_s", size),
        (FrictionLaw::Travel(size), true) => ("transition_m", size),
        (FrictionLaw::Travel(size), false) => ("transition_rad", size),
    };
    // a device file's friction has no share of the load: that of the mean load, then
    let share = own.load.map_or(0.0, |load| load.value);
    let dry = own.coulomb.value + share * own.carried;
    if dry <= 0.0 && own.viscous.value <= 0.0 {
        return None;
    }
    let stribeck = if slides { "stribeck_n" } else { "stribeck_nm" };
    let numbers = [
        (coulomb, dry),
        (viscous, own.viscous.value),
        (stribeck, 0.0),
        (transition, size),
    ];
    let interval = |own: &Estimated| own.ci95().map(Some);
    let of_mean = Estimated {
        value: dry,
        sd: (own.coulomb.sd).hypot(own.load.map_or(0.0, |load| load.sd * own.carried)),
    };
    let intervals = [(coulomb, &of_mean), (viscous, &own.viscous)];
    Some(DeviceEffect {
        name: FRICTION.to_owned(),
        joint: Some(own.joint),
        numbers: BTreeMap::from(numbers.map(|(name, value)| (name.to_owned(), value))),
        intervals: BTreeMap::from(intervals.map(|(name, own)| (name.to_owned(), interval(own)))),
        ..DeviceEffect::default()
    })
}
