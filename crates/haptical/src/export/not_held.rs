//! What a device has, and a control loop has no place for: masses, and numbers of the drives.

use haptical_model::{Device, DriveNumber, drive_numbers_in_words};
use haptical_runtime::{Effect, Over};

const MASSES: &str = "masses and inertias of the links are not held: torques are those of the hand's force and of the effects, without the \
                      arm's own weight and motion";
/// A replay of a moving arm works out what springs carry from the links' masses.
const LINK_TORQUES: &str = "springs between motor and link carry the torque that a step is given: on a moving arm give that of the \
                            link, which is the drive's less its friction and its armature's";

/// A sentence for each, of a device with these effects.
pub(super) fn not_held(device: &Device, effects: &[(String, Effect)]) -> Vec<String> {
    let weighs = device.bodies.iter().flatten().any(|own| own.mass_kg > 0.0);
    let is_loaded = |(_, effect): &(String, Effect)| match effect {
        Effect::CapstanCompliance { .. } | Effect::CapstanCreep { .. } => true,
        Effect::Curve { over, .. } => *over == Over::Torque,
        _ => false,
    };
    let springs = weighs && effects.iter().any(is_loaded);
    let numbers = drive_numbers_in_words(&device.joints, &DriveNumber::ALL).map(|joints| {
        format!(
            "numbers of the drives are not held: {joints}; a torque offset is to be taken off the torque that is read before a \
             step"
        )
    });
    let masses = weighs.then(|| MASSES.to_owned());
    let springs = springs.then(|| LINK_TORQUES.to_owned());
    masses.into_iter().chain(springs).chain(numbers).collect()
}
