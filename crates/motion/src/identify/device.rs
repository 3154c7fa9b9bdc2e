//! A device with the dynamics that were identified.

use std::collections::BTreeMap;

use haptical_model::{Device, DeviceEffect, FrictionNumber, JOINT_FRICTION, JointType, ModelError};

use crate::identify::friction::FrictionLaw;
use crate::identify::result::{Dynamics, Estimated, JointDynamics};

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
    device.effects.retain(|own| !own.is_friction());
    for own in &found.joints {
        let Some(joint) = device.joints.get_mut(own.joint) else {
            continue;
        };
        joint.armature_kgm2 = Some(own.armature.value.max(0.0));
        joint.torque_offset_nm = Some(own.offset.value);
        joint.torque_delay_s = found.delay_s.is_told().then_some(found.delay_s.value);
        device.effects.extend(friction(own, joint.joint_type));
    }
    Ok(device)
}

fn friction(own: &JointDynamics, joint_type: JointType) -> Option<DeviceEffect> {
    let [coulomb, viscous, stribeck] = [
        FrictionNumber::Coulomb,
        FrictionNumber::Viscous,
        FrictionNumber::Stribeck,
    ]
    .map(|number| number.key(joint_type));
    let (turnover, size) = match own.law {
        FrictionLaw::Speed(size) => (FrictionNumber::TurnoverSpeed, size),
        FrictionLaw::Travel(size) => (FrictionNumber::TurnoverTravel, size),
    };
    let transition = turnover.key(joint_type);
    // a device file's friction has no share of the load: that of the mean load, then
    let share = own.load.map_or(0.0, |load| load.value);
    let dry = own.coulomb.value + share * own.carried;
    if dry <= 0.0 && own.viscous.value <= 0.0 {
        return None;
    }
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
        name: JOINT_FRICTION.to_owned(),
        joint: Some(own.joint),
        numbers: BTreeMap::from(numbers.map(|(name, value)| (name.to_owned(), value))),
        intervals: BTreeMap::from(intervals.map(|(name, own)| (name.to_owned(), interval(own)))),
        ..DeviceEffect::default()
    })
}
