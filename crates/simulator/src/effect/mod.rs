//! Effects of a real device that the base model leaves out, with their sizes.

pub(crate) mod error;
pub(crate) mod file;
pub(crate) mod names;

use haptical_model::Device;
use serde::{Deserialize, Serialize};

use crate::effect::error::EffectError;
use crate::effect::names::known;

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

/// One effect. Joints count from 1, as in `effects.toml`; names and parameters are those of the
/// diagnosis. What each does: docs/equations.md, Motion simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names of the fields say quantity and unit")]
#[non_exhaustive]
pub enum Effect {
    /// The cable between the drums stretches: the output stays behind by torque over stiffness.
    CapstanCompliance {
        joint: usize,
        stiffness_nm_per_rad: f64,
    },
    /// The link behind the external encoder gives by torque over stiffness.
    JointCompliance {
        joint: usize,
        stiffness_nm_per_rad: f64,
    },
    /// Play of a total width between motor and output.
    Backlash {
        joint: usize,
        width_rad: f64,
        #[serde(default)]
        driven_by: Driver,
    },
    /// Friction in the transmission that strains the cable by up to the amplitude.
    Hysteresis {
        joint: usize,
        amplitude_rad: f64,
        transition_rad: f64,
        #[serde(default)]
        driven_by: Driver,
    },
    /// Viscous load of the transmission: the output stays behind by delay times speed.
    ViscousLag { joint: usize, delay_s: f64 },
    /// The motor-side reading is too high by some counts from a time on.
    EncoderCountLoss {
        joint: usize,
        counts: f64,
        time_s: f64,
    },
    /// The transmission's zero creeps with time or with the rise of temperature; one of the two.
    JointDrift {
        joint: usize,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rad_per_s: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rad_per_degc: Option<f64>,
    },
    /// The joint's axis tilts about the x axis of the link before by A cos(order theta - phase).
    AxisWobble {
        joint: usize,
        amplitude_rad: f64,
        phase_rad: f64,
        #[serde(default = "first_order")]
        order: f64,
    },
    /// The base turns by this times the moment of weights and hand about frame (0)'s origin.
    BaseCompliance { rad_per_nm: f64 },
    /// The handle moves against the last link by this times the hand's force.
    ToolCompliance { m_per_n: f64 },
    /// All motor-side readings are late.
    EncoderLatency { delay_s: f64 },
    /// The external encoder of a joint is late.
    ExternalEncoderLatency { joint: usize, delay_s: f64 },
    /// The cable's reading is late.
    CableLatency { delay_s: f64 },
    /// The cable bends over a round guide where it leaves its unit.
    CableExitGeometry { radius_m: f64 },
    /// The cable reads too long by this times the square of its angle to the exit axis.
    CableTwist { twist_m_per_rad2: f64 },
    /// The cable's zero is set wrong: the reading is too high by this.
    CableZeroOffset { offset_m: f64 },
    /// The drum's centre is off its axis.
    CableDrumEccentricity { amplitude_m: f64, phase_rad: f64 },
    /// The cable's zero creeps with time.
    CableDrift { m_per_s: f64 },
    /// The cable's unit moves along the cable with the rise of temperature.
    ThermalDrift { m_per_degc: f64 },
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
    /// [`EffectError::Value`] for a size outside its domain, [`EffectError::Twice`] for an effect that
    /// is there twice at one place (lost counts may be).
    pub fn new(effects: Vec<Effect>) -> Result<Self, EffectError> {
        Self::checked(effects, "effects")
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
            effect.check(file, index + 1)?;
            let is_step = matches!(effect, Effect::EncoderCountLoss { .. });
            let place = |other: &Effect| (other.name(), other.joint());
            let earlier = effects[..index]
                .iter()
                .any(|other| place(other) == place(effect));
            if earlier && !is_step {
                return Err(EffectError::Twice {
                    file: file.to_owned(),
                    number: index + 1,
                    name: effect.name(),
                });
            }
        }
        Ok(Self(effects))
    }

    /// Refuses effects that a device cannot have.
    pub(crate) fn check_device(&self, device: &Device, warms_up: bool) -> Result<(), EffectError> {
        for effect in &self.0 {
            let refuse = |needs: &'static str| EffectError::Device {
                name: effect.name(),
                joint: effect.joint(),
                needs,
            };
            if effect
                .joint()
                .is_some_and(|joint| joint > device.joints.len())
            {
                return Err(EffectError::NoJoint {
                    name: effect.name(),
                    joint: effect.joint().unwrap_or_default(),
                    joints: device.joints.len(),
                });
            }
            let known = known(effect.name());
            if known.is_some_and(|known| known.needs_links) && !device.has_links() {
                return Err(refuse("a device with [[link]] tables"));
            }
            if known.is_some_and(|known| known.needs_cable) && device.cables.is_empty() {
                return Err(refuse("a [cable_encoder]"));
            }
            let by_temperature = match effect {
                Effect::JointDrift { rad_per_degc, .. } => rad_per_degc.is_some(),
                Effect::ThermalDrift { .. } => true,
                _ => false,
            };
            if by_temperature && !warms_up {
                return Err(refuse("a temperature in the settings"));
            }
            let radius_m = device.cables.first().and_then(|cable| cable.drum_radius_m);
            if let Effect::CableDrumEccentricity { amplitude_m, .. } = effect
                && !radius_m.is_some_and(|radius_m| radius_m > amplitude_m.abs())
            {
                return Err(refuse("a drum_radius_m of the cable above the amplitude"));
            }
        }
        Ok(())
    }
}

impl Effect {
    /// Name, as in `effects.toml`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::CapstanCompliance { .. } => "capstan-compliance",
            Self::JointCompliance { .. } => "joint-compliance",
            Self::Backlash { .. } => "backlash",
            Self::Hysteresis { .. } => "hysteresis",
            Self::ViscousLag { .. } => "viscous-lag",
            Self::EncoderCountLoss { .. } => "encoder-count-loss",
            Self::JointDrift { .. } => "joint-drift",
            Self::AxisWobble { .. } => "axis-wobble",
            Self::BaseCompliance { .. } => "base-compliance",
            Self::ToolCompliance { .. } => "tool-compliance",
            Self::EncoderLatency { .. } => "encoder-latency",
            Self::ExternalEncoderLatency { .. } => "external-encoder-latency",
            Self::CableLatency { .. } => "cable-latency",
            Self::CableExitGeometry { .. } => "cable-exit-geometry",
            Self::CableTwist { .. } => "cable-twist",
            Self::CableZeroOffset { .. } => "cable-zero-offset",
            Self::CableDrumEccentricity { .. } => "cable-drum-eccentricity",
            Self::CableDrift { .. } => "cable-drift",
            Self::ThermalDrift { .. } => "thermal-drift",
        }
    }

    /// Joint that it acts on, from 1; none for an effect of the whole device.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            Self::CapstanCompliance { joint, .. }
            | Self::JointCompliance { joint, .. }
            | Self::Backlash { joint, .. }
            | Self::Hysteresis { joint, .. }
            | Self::ViscousLag { joint, .. }
            | Self::EncoderCountLoss { joint, .. }
            | Self::JointDrift { joint, .. }
            | Self::AxisWobble { joint, .. }
            | Self::ExternalEncoderLatency { joint, .. } => Some(joint),
            _ => None,
        }
    }

    /// Refuses a size outside its domain.
    fn check(&self, file: &str, number: usize) -> Result<(), EffectError> {
        let is = |parameter, value: f64, good: bool, allowed| {
            if good && value.is_finite() {
                return Ok(());
            }
            Err(EffectError::Value {
                file: file.to_owned(),
                number,
                name: self.name(),
                parameter,
                value,
                allowed,
            })
        };
        let finite = |parameter, value: f64| is(parameter, value, true, "a finite number");
        let positive =
            |parameter, value: f64| is(parameter, value, value > 0.0, "a finite number above 0");
        let not_negative = |parameter, value: f64| {
            is(parameter, value, value >= 0.0, "a finite number, 0 or more")
        };
        if let Some(joint) = self.joint() {
            is(
                "joint",
                joint as f64,
                joint > 0,
                "the joint's number, from 1",
            )?;
        }
        match *self {
            Self::CapstanCompliance {
                stiffness_nm_per_rad,
                ..
            }
            | Self::JointCompliance {
                stiffness_nm_per_rad,
                ..
            } => positive("stiffness_nm_per_rad", stiffness_nm_per_rad),
            Self::Backlash { width_rad, .. } => not_negative("width_rad", width_rad),
            Self::Hysteresis {
                amplitude_rad,
                transition_rad,
                ..
            } => {
                not_negative("amplitude_rad", amplitude_rad)?;
                positive("transition_rad", transition_rad)
            }
            Self::ViscousLag { delay_s, .. }
            | Self::EncoderLatency { delay_s }
            | Self::ExternalEncoderLatency { delay_s, .. }
            | Self::CableLatency { delay_s } => not_negative("delay_s", delay_s),
            Self::EncoderCountLoss { counts, time_s, .. } => {
                let good = counts == libm::trunc(counts);
                is("counts", counts, good, "a whole number of counts")?;
                finite("time_s", time_s)
            }
            Self::JointDrift {
                rad_per_s,
                rad_per_degc,
                ..
            } => match (rad_per_s, rad_per_degc) {
                (Some(rate), None) => finite("rad_per_s", rate),
                (None, Some(rate)) => finite("rad_per_degc", rate),
                _ => Err(EffectError::OneOfTwo {
                    file: file.to_owned(),
                    number,
                    name: self.name(),
                    parameters: ["rad_per_s", "rad_per_degc"],
                }),
            },
            Self::AxisWobble {
                amplitude_rad,
                phase_rad,
                order,
                ..
            } => {
                finite("amplitude_rad", amplitude_rad)?;
                finite("phase_rad", phase_rad)?;
                positive("order", order)
            }
            Self::BaseCompliance { rad_per_nm } => not_negative("rad_per_nm", rad_per_nm),
            Self::ToolCompliance { m_per_n } => not_negative("m_per_n", m_per_n),
            Self::CableExitGeometry { radius_m } => not_negative("radius_m", radius_m),
            Self::CableTwist { twist_m_per_rad2 } => finite("twist_m_per_rad2", twist_m_per_rad2),
            Self::CableZeroOffset { offset_m } => finite("offset_m", offset_m),
            Self::CableDrumEccentricity {
                amplitude_m,
                phase_rad,
            } => {
                finite("amplitude_m", amplitude_m)?;
                finite("phase_rad", phase_rad)
            }
            Self::CableDrift { m_per_s } => finite("m_per_s", m_per_s),
            Self::ThermalDrift { m_per_degc } => finite("m_per_degc", m_per_degc),
        }
    }
}
