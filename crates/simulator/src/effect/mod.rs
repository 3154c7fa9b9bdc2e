//! Effects of a real device that the base model leaves out, with their sizes.

pub(crate) mod error;
pub(crate) mod file;
pub(crate) mod names;
mod size;

use haptical_model::{Device, TransmissionKind};
use serde::{Deserialize, Serialize};

use crate::effect::error::EffectError;
use crate::effect::size::{Domain, Number, Size};

/// Which side of a play or of friction leads the other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Driver {
    /// The hand moves the link; the motor follows.
    #[default]
    Hand,
    /// The motor moves the link.
    Motor,
}

/// What an effect needs of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needs {
    /// Nothing but joints.
    Joints,
    /// Links, to act on or for the torque that they make.
    Links,
    /// Links and the cable encoder.
    Cable,
}

/// An effect that this crate can simulate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    pub(crate) name: &'static str,
    /// Keys in `effects.toml` but for `name`.
    pub(crate) keys: &'static [&'static str],
}

/// Declares the effects: each with its name, what it needs of a device, and its keys with the numbers that
/// they can have.
macro_rules! effects {
    ($(
        $(#[$doc:meta])*
        $name:literal $needs:ident $variant:ident {
            $($(#[$attribute:meta])* $key:ident: $kind:ty => $domain:ident),*
        }
    )*) => {
        /// One effect. Joints count from 1, as in `effects.toml`; names and parameters are those of the
        /// diagnosis. What each does: docs/equations.md, Motion simulation.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "name", rename_all = "kebab-case")]
        #[allow(missing_docs, reason = "the names of the fields say quantity and unit")]
        #[non_exhaustive]
        pub enum Effect {
            $($(#[$doc])* $variant { $($(#[$attribute])* $key: $kind),* },)*
        }

        /// All effects, in the order of the catalogue of docs/diagnosis.md.
        pub(crate) const KNOWN: &[Known] = &[
            $(Known { name: $name, keys: &[$(stringify!($key)),*] },)*
        ];

        impl Effect {
            /// Name, as in `effects.toml`.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $name,)*
                }
            }

            fn needs(&self) -> Needs {
                match self {
                    $(Self::$variant { .. } => Needs::$needs,)*
                }
            }

            /// Its numbers.
            fn sizes(&self) -> Vec<Size> {
                match *self {
                    $(Self::$variant { $($key),* } => vec![$(Size {
                        key: stringify!($key),
                        value: $key.number(),
                        domain: Domain::$domain,
                    }),*],)*
                }
            }
        }
    };
}

effects! {
    /// The cable between the drums stretches: the output stays behind by torque over stiffness.
    "capstan-compliance" Links CapstanCompliance {
        joint: usize => Joint,
        stiffness_nm_per_rad: f64 => Positive
    }
    /// Play of a total width between motor and output.
    "backlash" Joints Backlash {
        joint: usize => Joint,
        width_rad: f64 => NotNegative,
        #[serde(default)] driven_by: Driver => Any
    }
    /// Friction in the transmission that strains the cable by up to the amplitude.
    "hysteresis" Joints Hysteresis {
        joint: usize => Joint,
        amplitude_rad: f64 => NotNegative,
        transition_rad: f64 => Positive,
        #[serde(default)] driven_by: Driver => Any
    }
    /// Viscous load of the transmission: the output stays behind by delay times speed.
    "viscous-lag" Joints ViscousLag { joint: usize => Joint, delay_s: f64 => NotNegative }
    /// The motor-side reading is too high by some counts from a time on.
    "encoder-count-loss" Joints EncoderCountLoss {
        joint: usize => Joint,
        counts: f64 => Whole,
        time_s: f64 => Any
    }
    /// The transmission's zero creeps with time or with the rise of temperature; one of the two.
    "joint-drift" Joints JointDrift {
        joint: usize => Joint,
        #[serde(default, skip_serializing_if = "Option::is_none")] rad_per_s: Option<f64> => Any,
        #[serde(default, skip_serializing_if = "Option::is_none")] rad_per_degc: Option<f64> => Any
    }
    /// The external encoder of a joint is late.
    "external-encoder-latency" Joints ExternalEncoderLatency {
        joint: usize => Joint,
        delay_s: f64 => NotNegative
    }
    /// All motor-side readings are late.
    "encoder-latency" Joints EncoderLatency { delay_s: f64 => NotNegative }
    /// The cable's zero is set wrong: the reading is too high by this.
    "cable-zero-offset" Cable CableZeroOffset { offset_m: f64 => Any }
    /// The cable reads too long by this times the square of its angle to the exit axis.
    "cable-twist" Cable CableTwist { twist_m_per_rad2: f64 => Any }
    /// The cable bends over a round guide where it leaves its unit.
    "cable-exit-geometry" Cable CableExitGeometry { radius_m: f64 => NotNegative }
    /// The drum's centre is off its axis.
    "cable-drum-eccentricity" Cable CableDrumEccentricity {
        amplitude_m: f64 => Any,
        phase_rad: f64 => Any
    }
    /// The cable's unit moves along the cable with the rise of temperature.
    "thermal-drift" Cable ThermalDrift { m_per_degc: f64 => Any }
    /// The cable's zero creeps with time.
    "cable-drift" Cable CableDrift { m_per_s: f64 => Any }
    /// The cable's reading is late.
    "cable-latency" Cable CableLatency { delay_s: f64 => NotNegative }
    /// The link behind the external encoder gives by torque over stiffness.
    "joint-compliance" Links JointCompliance {
        joint: usize => Joint,
        stiffness_nm_per_rad: f64 => Positive
    }
    /// The joint's axis tilts about the x axis of the link before by A cos(order theta - phase).
    "axis-wobble" Links AxisWobble {
        joint: usize => Joint,
        amplitude_rad: f64 => Any,
        phase_rad: f64 => Any,
        #[serde(default = "first_order")] order: f64 => Positive
    }
    /// The base turns by this times the moment of weights and hand about frame (0)'s origin.
    "base-compliance" Links BaseCompliance { rad_per_nm: f64 => NotNegative }
    /// The handle moves against the last link by this times the hand's force.
    "tool-compliance" Links ToolCompliance { m_per_n: f64 => NotNegative }
    /// The drums of a joint are rough: its external encoder sees waves of 6 to 60 mrad of its angle, the same in every
    /// recording of a device.
    "drum-roughness" Joints DrumRoughness { joint: usize => Joint, rms_rad: f64 => NotNegative }
}

fn first_order() -> f64 {
    1.0
}

/// All effects of a simulated device.
///
/// ```
/// use haptical_simulator::{Effect, Effects};
/// let text = "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n";
/// let effects = Effects::from_toml(text, "effects.toml")?;
/// let want = Effect::CapstanCompliance { joint: 2, stiffness_nm_per_rad: 260.0 };
/// assert_eq!(effects.as_slice(), [want]);
///
/// let wrong = text.replace("compliance", "complaince");
/// let error = Effects::from_toml(&wrong, "effects.toml").unwrap_err().to_string();
/// assert!(error.contains("did you mean `capstan-compliance`?"), "{error}");
/// # Ok::<(), haptical_simulator::EffectError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Effects(Vec<Effect>);

impl Effects {
    /// No effects: the base model is right.
    pub fn none() -> Self {
        Self::default()
    }

    /// Effects with sizes that they can have.
    ///
    /// # Errors
    /// [`EffectError`] for a size outside its domain, and for an effect that is there twice at one place (lost
    /// counts may be).
    pub fn new(effects: Vec<Effect>) -> Result<Self, EffectError> {
        Self::checked(effects, "effects")
    }

    /// These, and the roughness that the paper's device is assumed to have where nothing is said of it: 0.3 mrad on
    /// joints 3 and 4, 0.03 mrad on other joints with drums, none on direct ones (assumption A47 of
    /// docs/assumptions.md).
    ///
    /// # Errors
    /// [`EffectError`] where a joint's roughness is there already.
    pub fn with_assumed_roughness(mut self, device: &Device) -> Result<Self, EffectError> {
        const ROUGH_JOINTS: [usize; 2] = [2, 3];
        const ROUGH_RMS_RAD: f64 = 3e-4;
        const SMOOTH_RMS_RAD: f64 = 3e-5;
        let joints = device.joints.iter().enumerate();
        let driven = joints.filter(|(_, joint)| joint.transmission != TransmissionKind::Direct);
        self.0
            .extend(driven.map(|(joint, _)| Effect::DrumRoughness {
                joint: joint + 1,
                rms_rad: match ROUGH_JOINTS.contains(&joint) {
                    true => ROUGH_RMS_RAD,
                    false => SMOOTH_RMS_RAD,
                },
            }));
        Self::checked(self.0, "effects")
    }

    /// Reads `effects.toml`: a table `[[effect]]` for each, with its `name` and parameters.
    ///
    /// # Errors
    /// [`EffectError`] with the file, the number of the effect and what is allowed there.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, EffectError> {
        Self::checked(file::parse(text, file)?, file)
    }

    /// The effects, in the order given.
    pub fn as_slice(&self) -> &[Effect] {
        &self.0
    }

    fn checked(effects: Vec<Effect>, file: &str) -> Result<Self, EffectError> {
        for (index, effect) in effects.iter().enumerate() {
            let (number, name) = (index + 1, effect.name());
            let place = || format!("{file}, effect {number} (`{name}`)");
            effect
                .check()
                .map_err(|what| EffectError::new(place(), what))?;
            let is_step = matches!(effect, Effect::EncoderCountLoss { .. });
            let at_place = |other: &Effect| (other.name(), other.joint());
            let mut earlier = effects[..index].iter();
            if !is_step && earlier.any(|other| at_place(other) == at_place(effect)) {
                let what = format!("`{name}` is there already at this place; give it once");
                return Err(EffectError::new(format!("{file}, effect {number}"), what));
            }
        }
        Ok(Self(effects))
    }

    /// Refuses effects that a device cannot have.
    pub(crate) fn check_device(&self, device: &Device, warms_up: bool) -> Result<(), EffectError> {
        let joints = device.joints.len();
        let drum_m = device.cables.first().and_then(|cable| cable.drum_radius_m);
        for effect in &self.0 {
            let (name, joint) = (effect.name(), effect.joint());
            if let Some(joint) = joint.filter(|joint| *joint > joints) {
                let what = format!("joint {joint}, but the device has joints 1 to {joints}");
                return Err(EffectError::new(format!("effect `{name}`"), what));
            }
            let needs = effect.needs();
            let mut sizes = effect.sizes().into_iter();
            let by_temperature =
                sizes.any(|size| size.key.ends_with("per_degc") && size.value.is_some());
            let lacking = if needs != Needs::Joints && !device.has_links() {
                "a device with [[link]] tables"
            } else if needs == Needs::Cable && device.cables.is_empty() {
                "a [cable_encoder]"
            } else if by_temperature && !warms_up {
                "a temperature in the settings"
            } else if let Effect::CableDrumEccentricity { amplitude_m, .. } = effect
                && drum_m.is_none_or(|radius_m| radius_m <= amplitude_m.abs())
            {
                "a drum_radius_m of the cable above the amplitude"
            } else {
                continue;
            };
            let place = match joint {
                Some(joint) => format!("effect `{name}` of joint {joint}"),
                None => format!("effect `{name}`"),
            };
            return Err(EffectError::new(place, format!("it needs {lacking}")));
        }
        Ok(())
    }
}

impl Effect {
    /// Joint that it acts on, from 1; none for an effect of the whole device.
    pub fn joint(&self) -> Option<usize> {
        let mut sizes = self.sizes().into_iter();
        let joint = sizes.find(|size| size.domain == Domain::Joint)?;
        joint.value.map(|number| number as usize)
    }

    /// Why its numbers cannot be.
    fn check(&self) -> Result<(), String> {
        self.sizes().iter().try_for_each(Size::check)?;
        match self {
            Self::JointDrift {
                rad_per_s,
                rad_per_degc,
                ..
            } if rad_per_s.is_some() == rad_per_degc.is_some() => {
                Err("give `rad_per_s` or `rad_per_degc`, one of the two".to_owned())
            }
            _ => Ok(()),
        }
    }
}
