//! Poses of all ends and torques of all joints, by haptical.

use haptical_model::kinematics::Pose;
use haptical_model::{Body, Device, DeviceChain, FrictionNumber, Missing, ModelError, RigidBodies};

use super::subject::Motion;

/// Haptical's answers at all motions.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ours {
    /// Of each motion, of each end.
    pub(crate) poses: Vec<Vec<Pose>>,
    /// None where the device has no masses.
    pub(crate) torques: Option<Torques>,
    /// What haptical says of masses that are missing.
    pub(crate) said: Vec<String>,
}

/// Torques of each motion, of each joint \[N m\], \[N\].
#[derive(Debug, Clone, Default)]
pub(crate) struct Torques {
    /// At rest.
    pub(crate) still: Vec<Vec<f64>>,
    /// In motion, friction included; none where an inertia is not known.
    pub(crate) moving: Option<Vec<Vec<f64>>>,
}

/// Computes them.
pub(crate) fn ours(device: &Device, motions: &[Motion]) -> Result<Ours, ModelError> {
    let ends = device.hands.len().max(1);
    let chains: Vec<DeviceChain> = (0..ends)
        .map(|hand| DeviceChain::of_hand(device, hand))
        .collect();
    let mut answer = Ours::default();
    for motion in motions {
        let poses: Result<Vec<Pose>, _> = chains.iter().map(|own| own.pose(&motion.q)).collect();
        answer.poses.push(poses?);
    }
    if device.gravity_mps2.is_none() {
        return Ok(answer);
    }
    let (bodies, is_whole, said) = bodies(device)?;
    answer.said = said;
    let mut work = bodies.work();
    let mut torques = Torques {
        still: Vec::new(),
        moving: is_whole.then(Vec::new),
    };
    let rest = vec![0.0; device.joints.len()];
    for motion in motions {
        let mut tau = rest.clone();
        bodies.torques(&motion.q, &rest, &rest, &mut work, &mut tau)?;
        torques.still.push(tau);
        let Some(moving) = &mut torques.moving else {
            continue;
        };
        let mut tau = rest.clone();
        bodies.torques(&motion.q, &motion.dq, &motion.ddq, &mut work, &mut tau)?;
        for (joint, own) in tau.iter_mut().enumerate() {
            let [dry, viscous] = friction(device, joint);
            let speed = motion.dq.get(joint).copied().unwrap_or(0.0);
            *own += dry * speed.signum() + viscous * speed;
        }
        moving.push(tau);
    }
    answer.torques = Some(torques);
    Ok(answer)
}

/// Bodies as the file has them, whether all inertias are known, and what is said of what is missing.
///
/// A row without any mass counts as massless, which is what a simulator makes of it.
fn bodies(device: &Device) -> Result<(RigidBodies, bool, Vec<String>), ModelError> {
    let error = match RigidBodies::of_device(device) {
        Ok(bodies) => return Ok((bodies, true, Vec::new())),
        Err(error) => error,
    };
    let ModelError::Unweighed { missing, .. } = &error else {
        return Err(error);
    };
    let mut filled = device.clone();
    filled.bodies.resize(device.links.len(), None);
    for row in missing.iter().filter_map(Missing::row) {
        if let Some(body @ None) = filled.bodies.get_mut(row) {
            *body = Some(Body {
                mass_kg: 0.0,
                centre_of_mass_m: [0.0; 3],
                inertia_kgm2: None,
            });
        }
    }
    let said = vec![error.to_string()];
    if let Ok(bodies) = RigidBodies::of_device(&filled) {
        return Ok((bodies, true, said));
    }
    // torques at rest need no inertia: any that a body has will do
    for row in missing.iter().filter_map(Missing::row) {
        if let Some(Some(body)) = filled.bodies.get_mut(row) {
            body.inertia_kgm2 = Some([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        }
    }
    Ok((RigidBodies::of_device(&filled)?, false, said))
}

/// Coulomb's friction and that per speed of a joint, as the device has them.
pub(crate) fn friction(device: &Device, joint: usize) -> [f64; 2] {
    let effects = device.effects.iter();
    let mut own = effects.filter(|own| own.is_friction() && own.joint == Some(joint));
    let kind = device.joints.get(joint).map(|own| own.joint_type);
    let (Some(effect), Some(kind)) = (own.next(), kind) else {
        return [0.0; 2];
    };
    [FrictionNumber::Coulomb, FrictionNumber::Viscous]
        .map(|number| effect.numbers.get(number.key(kind)).copied().unwrap_or(0.0))
}
