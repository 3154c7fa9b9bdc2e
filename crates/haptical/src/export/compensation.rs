//! The effects of a device as the runtime takes them, and those that a control loop has no use for.

use std::path::Path;

use haptical_effects::correction::{self, curve_of};
use haptical_effects::device::{OwnEffect, effects_of};
use haptical_effects::{Context, Form, Hook, Shape, joint_origin_m};
use haptical_model::transmission::loops::{STRIBECK_M_PER_S, STRIBECK_RAD_PER_S};
use haptical_model::{Device, DeviceChain, JointType, Recording, Statics};
use haptical_runtime::{Effect, Over, Side, Turnover};
use haptical_urdf::ENCODERS_AHEAD;

use super::not_held::not_held;
use crate::error::Error as Failure;

/// Effects of an export.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Compensation {
    /// Each with its label: `backlash@3`.
    pub(super) effects: Vec<(String, Effect)>,
    /// What is left out, and why.
    pub(super) left_out: Vec<LeftOut>,
    /// What else of the device has no place, in sentences.
    pub(super) not_held: Vec<String>,
}

/// An effect that is not in an export.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LeftOut {
    pub(super) label: String,
    pub(super) why: &'static str,
}

impl LeftOut {
    pub(super) fn warning(&self) -> String {
        format!("effect `{}` is left out: {}", self.label, self.why)
    }
}

const NOT_READ: &str = "it shows on a sensor that a control loop does not read";
const ONE_OF_TWO: &str = "the zero is either that of the first runs or that of the last ones: identify the device with a log of its own";
const EVENT: &str = "it is an event of one recording, which homing takes away";
const UNKNOWN: &str = "its numbers are not known yet: identify the device first";
const NO_AXIS: &str = "its joint slides or moves several rows";
const NO_GRAVITY: &str = "the device file has no [gravity]";

impl Compensation {
    /// Of a device with its links; it has one hand.
    pub(super) fn new(device: &Device, path: &Path) -> Result<Self, Failure> {
        let refuse = |what: String| {
            let next = "correct [[effect]] in the device file";
            Failure::in_file("not-exportable", what, path, next)
        };
        let own = effects_of(device).map_err(|error| refuse(error.to_string()))?;
        // numbers of laws need no recording
        let nothing = Recording::default();
        let context =
            Context::new(device, &nothing, &[]).map_err(|error| refuse(error.to_string()))?;
        let at_zero = vec![0.0; device.joints.len()];
        let base = DeviceChain::to_row(device, 0);
        let base_m = base.chain().and_then(|chain| chain.pose(&[]));
        let base_m = base_m
            .map_err(|error| refuse(error.to_string()))?
            .position_m;
        let place = Place {
            device,
            base_m: base_m.into(),
        };
        let mut compensation = Self::default();
        for effect in &own {
            let label = device.effects[effect.index].label();
            match place.runtime_effects(effect, &context) {
                Ok(effects) => compensation
                    .effects
                    .extend(effects.into_iter().map(|effect| (label.clone(), effect))),
                Err(why) => compensation.left_out.push(LeftOut { label, why }),
            }
        }
        for joint in 0..device.joints.len() {
            let rad_per_nm = device.compliance_rad_per_nm(joint);
            if rad_per_nm != 0.0 {
                let label = format!("joint-compliance@{}", joint + 1);
                let effect = Effect::JointCompliance { joint, rad_per_nm };
                compensation.effects.push((label, effect));
            }
        }
        compensation.not_held = not_held(device, &compensation.effects);
        let bears = |(_, effect): &(String, Effect)| {
            matches!(
                effect,
                Effect::LateralCompliance { .. } | Effect::BaseCompliance { .. }
            )
        };
        if compensation.effects.iter().any(bears) {
            let weights = Statics::new(device).weights(&at_zero);
            for weight in weights.map_err(|error| refuse(error.to_string()))? {
                let effect = Effect::Weight {
                    row: weight.row.saturating_sub(1),
                    place_m: weight.place_m.into(),
                    force_n: weight.force_n.into(),
                };
                compensation
                    .effects
                    .push((format!("weight of link {}", weight.row), effect));
            }
        }
        Ok(compensation)
    }

    /// All that is left out, a sentence each.
    pub(super) fn warnings(&self) -> impl Iterator<Item = String> {
        let effects = self.left_out.iter().map(LeftOut::warning);
        effects.chain(self.not_held.iter().cloned())
    }
}

/// Where effects are.
struct Place<'d> {
    device: &'d Device,
    base_m: [f64; 3],
}

impl Place<'_> {
    /// The runtime's effects of one law, or why there are none.
    fn runtime_effects(
        &self,
        own: &OwnEffect,
        context: &Context<'_>,
    ) -> Result<Vec<Effect>, &'static str> {
        let spec = own.effect.spec();
        if spec.form == Form::Curve {
            return self.curve(own).map(|effect| vec![effect]);
        }
        let Some(values) = &own.values else {
            return Err(UNKNOWN);
        };
        match (spec.hook, spec.form) {
            (Hook::ExternalEncoder | Hook::CableSensor | Hook::Tracker | Hook::Readings, _) => {
                return Err(NOT_READ);
            }
            (_, Form::Step) if spec.shape == Shape::Event => return Err(EVENT),
            (_, Form::Step) => return Err(ONE_OF_TWO),
            _ => {}
        }
        let (amplitudes, shape) = own.amplitudes(context);
        let law = Law {
            own,
            values,
            amplitudes: &amplitudes,
            shape,
            joint: own.effect.joint().unwrap_or(0),
            from: own.effect.other_joint().unwrap_or(0),
        };
        match spec.hook {
            Hook::Timing if law.amplitude(0) < 0.0 => Err(ENCODERS_AHEAD),
            Hook::Timing => Ok(vec![Effect::EncoderLatency {
                delay_s: law.amplitude(0),
            }]),
            Hook::Transmission => self.of_drive(&law).map(|effect| vec![effect]),
            Hook::Structure => self.of_structure(&law).map(|effect| vec![effect]),
            _ => self.of_torques(&law),
        }
    }

    fn curve(&self, own: &OwnEffect) -> Result<Effect, &'static str> {
        let entry = self.device.effects.get(own.index).ok_or(UNKNOWN)?;
        let curve = curve_of(self.device, own.index, entry);
        let (curve, joint) = curve.map_err(|_| UNKNOWN)?;
        Ok(Effect::Curve {
            joint,
            over: match curve.over {
                correction::Over::Angle => Over::Angle,
                correction::Over::Torque => Over::Torque,
                correction::Over::Temperature => Over::Temperature,
                correction::Over::Time => Over::Time,
            },
            lower: curve.range[0],
            upper: curve.range[1],
            // an export holds its effects until the process ends
            coefficients: curve.coefficients.leak(),
        })
    }

    fn of_drive(&self, law: &Law<'_>) -> Result<Effect, &'static str> {
        let (joint, from) = (law.joint, law.from);
        let ratio = self.ratio(joint);
        Ok(match law.form() {
            Form::Spring => Effect::CapstanCompliance {
                joint,
                rad_per_nm: law.amplitude(0),
            },
            Form::Play if law.shape > HAND => {
                return Err("a play that follows the load needs the load's sign at every tick");
            }
            Form::Play => Effect::Backlash {
                joint,
                width_rad: law.value(0),
                // of one that is read at its other side the sign is the other one
                driven_by: match law.amplitude(0) < 0.0 {
                    true => side(HAND - law.shape),
                    false => side(law.shape),
                },
            },
            Form::Loop => Effect::Hysteresis {
                joint,
                amplitude_rad: law.value(0),
                transition_rad: law.shape,
                driven_by: side(law.further("driven_by")),
            },
            Form::Creep => Effect::CapstanCreep {
                joint,
                creep_per_nm: law.amplitude(0),
            },
            Form::Delay => Effect::ViscousLag {
                joint,
                delay_s: law.amplitude(0),
            },
            Form::Harmonic(periods) => Effect::Harmonic {
                joint,
                periods: periods.unwrap_or(law.shape * ratio),
                cosine_rad: law.amplitude(0),
                sine_rad: law.amplitude(1),
            },
            Form::Polynomial => Effect::CablePitch {
                joint,
                quadratic_per_rad: law.amplitude(0),
                cubic_per_rad2: law.amplitude(1),
            },
            Form::Scale => Effect::Coupling {
                joint,
                from: joint,
                gain: -law.amplitude(0) / ratio,
            },
            Form::Coupling => Effect::Coupling {
                joint,
                from,
                gain: law.amplitude(0),
            },
            Form::CoupledPlay => Effect::CoupledBacklash {
                joint,
                from,
                width_rad: law.value(0),
                play_rad: law.value(1),
            },
            Form::Drift => law.drift(),
            Form::Warming => Effect::WarmDrift {
                joint,
                rad_per_degc: law.value(0),
                reference_degc: law.further("reference_degc"),
            },
            _ => return Err(NOT_READ),
        })
    }

    fn of_structure(&self, law: &Law<'_>) -> Result<Effect, &'static str> {
        let joint = law.joint;
        let origin_m = || {
            let origin_m = joint_origin_m(self.device, joint).ok_or(NO_AXIS)?;
            Ok::<[f64; 3], &'static str>(origin_m.into())
        };
        Ok(match law.form() {
            Form::Spring => Effect::LateralCompliance {
                joint,
                rad_per_nm: law.amplitude(0),
                origin_m: origin_m()?,
            },
            Form::BaseSpring => Effect::BaseCompliance {
                rad_per_nm: law.amplitude(0),
                base_m: self.base_m,
            },
            Form::ToolSpring => Effect::ToolCompliance {
                m_per_n: law.amplitude(0),
            },
            Form::Wobble => Effect::AxisWobble {
                joint,
                order: law.shape,
                cosine_rad: [law.amplitude(0), law.amplitude(2)],
                sine_rad: [law.amplitude(1), law.amplitude(3)],
                origin_m: origin_m()?,
            },
            Form::Warming => Effect::ThermalGrowth {
                per_degc: law.value(0) / law.further("length_m"),
                reference_degc: law.further("reference_degc"),
                base_m: self.base_m,
            },
            Form::Shift => Effect::ToolChanged {
                shift_m: law.amplitudes(0),
            },
            _ => return Err(NOT_READ),
        })
    }

    fn of_torques(&self, law: &Law<'_>) -> Result<Vec<Effect>, &'static str> {
        let joint = law.joint;
        Ok(vec![match (law.own.effect.spec().hook, law.form()) {
            (Hook::Torque, Form::Scale) => Effect::TorqueGain {
                joint,
                gain: law.amplitude(0),
            },
            (_, Form::Friction) => self.friction(law),
            (_, Form::Harmonic(periods)) => Effect::MotorCogging {
                joint,
                periods: periods.unwrap_or(law.shape * self.ratio(joint)),
                cosine_nm: law.amplitude(0),
                sine_nm: law.amplitude(1),
            },
            (_, Form::Mass) => Effect::Payload {
                mass_kg: law.amplitude(0),
                gravity_mps2: self.device.gravity_mps2.ok_or(NO_GRAVITY)?,
            },
            (_, Form::Offset) => {
                let bias_n = law.amplitudes(0);
                let bias = Effect::ForceBias { bias_n };
                if law.amplitudes.len() < 6 {
                    return Ok(vec![bias]);
                }
                let warm = Effect::ForceWarmBias {
                    n_per_degc: law.amplitudes(3),
                    reference_degc: law.further("reference_degc"),
                };
                return Ok(vec![bias, warm]);
            }
            (_, Form::Scale) => Effect::ForceGain {
                gain: [law.value(0), law.value(1), law.value(2)],
            },
            (_, Form::Coupling) => Effect::ForceCrosstalk {
                parts: std::array::from_fn(|index| law.amplitude(index)),
            },
            (_, Form::Loop) => Effect::ForceHysteresis {
                size_n: law.amplitudes(0),
                transition_n: law.shape,
            },
            _ => return Err(NOT_READ),
        }])
    }

    fn friction(&self, law: &Law<'_>) -> Effect {
        let slides = self
            .device
            .joints
            .get(law.joint)
            .is_some_and(|joint| joint.joint_type == JointType::Prismatic);
        let parameters = law.own.effect.spec().parameters;
        let is_rate = parameters
            .iter()
            .any(|own| own.name.starts_with("transition_") && own.name.ends_with("_per_s"));
        Effect::Friction {
            joint: law.joint,
            coulomb_nm: law.amplitude(0),
            viscous_nm_s_per_rad: law.amplitude(1),
            stribeck_nm: law.amplitude(2),
            stribeck_rad_per_s: if slides {
                STRIBECK_M_PER_S
            } else {
                STRIBECK_RAD_PER_S
            },
            side: match is_rate {
                true => Turnover::Rate(law.shape),
                false => Turnover::Travel(law.shape),
            },
        }
    }

    fn ratio(&self, joint: usize) -> f64 {
        let own = self.device.joints.get(joint);
        own.map_or(1.0, |joint| joint.transmission_ratio)
    }
}

/// Number of a play that the hand drives; beyond it the load does.
const HAND: f64 = 1.0;

fn side(number: f64) -> Side {
    if number > 0.0 {
        Side::Hand
    } else {
        Side::Motor
    }
}

/// A law with its numbers.
struct Law<'o> {
    own: &'o OwnEffect,
    values: &'o [f64],
    amplitudes: &'o [f64],
    shape: f64,
    joint: usize,
    from: usize,
}

impl Law<'_> {
    fn form(&self) -> Form {
        self.own.effect.spec().form
    }

    fn amplitude(&self, index: usize) -> f64 {
        self.amplitudes.get(index).copied().unwrap_or(0.0)
    }

    /// Three amplitudes from one on.
    fn amplitudes(&self, first: usize) -> [f64; 3] {
        std::array::from_fn(|axis| self.amplitude(first + axis))
    }

    fn value(&self, index: usize) -> f64 {
        self.values.get(index).copied().unwrap_or(0.0)
    }

    fn further(&self, name: &str) -> f64 {
        let names = self.own.effect.spec().further.iter();
        let mut pairs = names.zip(&self.own.further);
        let found = pairs.find(|(further, _)| further.name == name);
        found.map_or(0.0, |(_, value)| *value)
    }

    /// A drift by its further numbers: until it settles, or steadily.
    fn drift(&self) -> Effect {
        let joint = self.joint;
        let (time_constant_s, over_s) = (self.further("time_constant_s"), self.further("over_s"));
        if time_constant_s <= 0.0 || over_s <= 0.0 {
            let rad_per_s = self.value(0);
            return Effect::Drift { joint, rad_per_s };
        }
        let settled = haptical_model::transmission::loops::settled(over_s, time_constant_s);
        Effect::SettlingDrift {
            joint,
            end_rad: self.value(0) * over_s / settled,
            time_constant_s,
        }
    }
}
