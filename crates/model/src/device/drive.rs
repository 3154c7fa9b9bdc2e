//! The numbers of a joint's drive in motion: the one list of the keys that an identification of the dynamics writes.

use std::fmt;

use crate::{DeviceEffect, Joint, JointType};

/// Name of a joint's friction in the catalogue of effects.
pub const JOINT_FRICTION: &str = "joint-friction";

/// A number of a `[[joint]]` that its equation of motion, or the reading of its torque, depends on.
///
/// ```
/// use haptical_model::{Device, DriveNumber};
/// let text = "[[joint]]\ntype = \"prismatic\"\ntorque_offset_n = 2.0\n";
/// let device = Device::from_toml(text, "slide.toml")?.device;
/// assert_eq!(DriveNumber::TorqueOffset.stated(&device.joints[0]), Some(2.0));
/// assert_eq!(DriveNumber::TorqueOffset.words(&device.joints[0]), Some("torque offset 2 N".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveNumber {
    /// What rotor and gear add to the inertia.
    Armature,
    /// Largest torque.
    TorqueLimit,
    /// What the torque reads where the drive gives none.
    TorqueOffset,
    /// How much later the torque is logged than the position.
    TorqueDelay,
}

impl DriveNumber {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Armature,
        Self::TorqueLimit,
        Self::TorqueOffset,
        Self::TorqueDelay,
    ];

    /// Its key in a device file.
    pub fn key(self, joint_type: JointType) -> &'static str {
        match (self, joint_type) {
            (Self::Armature, JointType::Revolute) => "armature_kgm2",
            (Self::Armature, JointType::Prismatic) => "armature_kg",
            (Self::TorqueLimit, JointType::Revolute) => "torque_limit_nm",
            (Self::TorqueLimit, JointType::Prismatic) => "torque_limit_n",
            (Self::TorqueOffset, JointType::Revolute) => "torque_offset_nm",
            (Self::TorqueOffset, JointType::Prismatic) => "torque_offset_n",
            (Self::TorqueDelay, _) => "torque_delay_s",
        }
    }

    /// Its value, where the device file gives one.
    pub fn stated(self, joint: &Joint) -> Option<f64> {
        match self {
            Self::Armature => joint.armature_kgm2,
            Self::TorqueLimit => joint.torque_limit_nm,
            Self::TorqueOffset => joint.torque_offset_nm,
            Self::TorqueDelay => joint.torque_delay_s,
        }
    }

    /// Gives it another value.
    pub fn set(self, joint: &mut Joint, value: Option<f64>) {
        match self {
            Self::Armature => joint.armature_kgm2 = value,
            Self::TorqueLimit => joint.torque_limit_nm = value,
            Self::TorqueOffset => joint.torque_offset_nm = value,
            Self::TorqueDelay => joint.torque_delay_s = value,
        }
    }

    /// Its name and size with the unit, for a sentence on what is left out; none where it is not given or 0.
    pub fn words(self, joint: &Joint) -> Option<String> {
        let value = self.stated(joint).filter(|value| *value != 0.0)?;
        let of_torque = joint.torque_unit();
        let inertia = match joint.joint_type {
            JointType::Revolute => "kg m^2",
            JointType::Prismatic => "kg",
        };
        Some(match self {
            Self::Armature => format!("armature {} {inertia}", four_digits(value)),
            Self::TorqueLimit => format!("torque limit {} {of_torque}", four_digits(value)),
            Self::TorqueOffset => format!("torque offset {} {of_torque}", four_digits(value)),
            Self::TorqueDelay => format!("torque delay {} ms", four_digits(1e3 * value)),
        })
    }
}

/// A number to four digits.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Which of some numbers a device's drives have, joint by joint, for a sentence on what is left out: `joint 2 (torque offset
/// 0.1622 N m)`; none where no joint has one.
pub fn drive_numbers_in_words(joints: &[Joint], numbers: &[DriveNumber]) -> Option<String> {
    let of = |(joint, own): (usize, &Joint)| {
        let words = numbers.iter().filter_map(|number| number.words(own));
        let words: Vec<String> = words.collect();
        (!words.is_empty()).then(|| format!("joint {} ({})", joint + 1, words.join(", ")))
    };
    let joints: Vec<String> = joints.iter().enumerate().filter_map(of).collect();
    (!joints.is_empty()).then(|| joints.join(", "))
}

/// A number of a `joint-friction`, an `[[effect]]` of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionNumber {
    /// Coulomb's friction.
    Coulomb,
    /// Friction per speed.
    Viscous,
    /// What friction near rest is more.
    Stribeck,
    /// The speed over which Coulomb's friction changes sides.
    TurnoverSpeed,
    /// The travel over which it does.
    TurnoverTravel,
}

impl FrictionNumber {
    /// All of them; a friction has one of the two turnovers.
    pub const ALL: [Self; 5] = [
        Self::Coulomb,
        Self::Viscous,
        Self::Stribeck,
        Self::TurnoverSpeed,
        Self::TurnoverTravel,
    ];

    /// Its key in a device file.
    pub fn key(self, joint_type: JointType) -> &'static str {
        let [turning, sliding] = match self {
            Self::Coulomb => ["coulomb_nm", "coulomb_n"],
            Self::Viscous => ["viscous_nm_s_per_rad", "viscous_n_s_per_m"],
            Self::Stribeck => ["stribeck_nm", "stribeck_n"],
            Self::TurnoverSpeed => ["transition_rad_per_s", "transition_m_per_s"],
            Self::TurnoverTravel => ["transition_rad", "transition_m"],
        };
        match joint_type {
            JointType::Revolute => turning,
            JointType::Prismatic => sliding,
        }
    }

    /// Its value in an effect, whichever unit its joint has.
    pub fn stated(self, effect: &DeviceEffect) -> Option<f64> {
        let types = [JointType::Revolute, JointType::Prismatic];
        let mut keys = types.into_iter().map(|own| self.key(own));
        keys.find_map(|key| effect.numbers.get(key).copied())
    }
}

/// An effect with its sizes, as it is said of one that is left out: `backlash@2 (width_rad 0.0012)`.
#[derive(Debug, Clone, Copy)]
pub struct SizedEffect<'e>(pub &'e DeviceEffect);

impl fmt::Display for SizedEffect<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = self.0.numbers.iter();
        let numbers = numbers.map(|(key, value)| format!("{key} {}", four_digits(*value)));
        let numbers: Vec<String> = numbers.collect();
        match numbers.as_slice() {
            [] => write!(formatter, "{}", self.0.label()),
            numbers => write!(formatter, "{} ({})", self.0.label(), numbers.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Device;

    /// Every key is read and written, in both units; a file's numbers come back.
    #[test]
    fn every_number_of_a_drive_is_read_and_written() {
        for (kind, joint_type) in [
            ("revolute", JointType::Revolute),
            ("prismatic", JointType::Prismatic),
        ] {
            for number in DriveNumber::ALL {
                let key = number.key(joint_type);
                let text = format!("[[joint]]\ntype = \"{kind}\"\n{key} = 0.125\n");
                let read = Device::from_toml(&text, "one.toml").unwrap();
                assert!(read.warnings.is_empty(), "{:?}", read.warnings);
                let mut device = read.device;
                assert_eq!(number.stated(&device.joints[0]), Some(0.125), "{key}");
                assert!(
                    device
                        .to_new_toml()
                        .unwrap()
                        .contains(&format!("{key} = 0.125"))
                );
                number.set(&mut device.joints[0], Some(0.25));
                let changed = device.to_toml(&text, "one.toml").unwrap();
                assert!(changed.contains(&format!("{key} = 0.25")), "{changed}");
                let words = drive_numbers_in_words(&device.joints, &DriveNumber::ALL);
                let size = if number == DriveNumber::TorqueDelay {
                    "250 ms"
                } else {
                    "0.25"
                };
                assert!(words.is_some_and(|own| own.contains(size)), "{key}");
            }
        }
    }
}
