//! What a device's effects are in MuJoCo's means, and the list of those that it has no means for.

use haptical_effects::{Form, Hook, law};
use haptical_model::{Device, DeviceEffect, FrictionNumber, JointType};

use crate::numbers::rounded;

/// Latest that a sensor may be \[s\]: MuJoCo keeps every reading in between.
const LATEST_S: f64 = 1.0;
/// Stiffness from which a spring is rigid \[Nm/rad\], \[N/m\].
const RIGID: f64 = 1e9;

/// What a description without a device's effects is worth.
pub(crate) const FITTED_BESIDE: &str = "lengths and offsets were fitted beside them: without them a plain fit (`haptical identify`), whose \
     numbers make up for them, can be nearer to the arm";

/// Why motor encoders that are ahead of the other sensors are in no description.
pub const AHEAD: &str = "motor encoders that are ahead of all else are no property of an arm; usually the other sensor of the log \
     (the tracker) is late, so check its time stamps";

/// A motion of its own along a joint's axis, between its motor and its link.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Yield {
    /// What the joint's name is followed by.
    pub(crate) suffix: &'static str,
    pub(crate) kind: YieldKind,
    /// Whether the external encoder sees it.
    pub(crate) is_before_encoder: bool,
}

/// What it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum YieldKind {
    /// A spring \[Nm/rad\], \[N/m\].
    Spring(f64),
    /// A play of a total width \[rad\], \[m\].
    Play(f64),
    /// It moves with another joint (from 0), this much.
    Coupling(f64, usize),
}

impl YieldKind {
    /// `a spring of 400 Nm/rad or N/m`.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Spring(stiffness) => format!("a spring of {} Nm/rad or N/m", rounded(stiffness)),
            Self::Play(width) => format!("a play of {} rad or m", rounded(width)),
            Self::Coupling(gain, from) => {
                format!("{} times joint {}", rounded(gain), from + 1)
            }
        }
    }
}

/// Friction of a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Friction {
    /// \[Nm\], \[N\].
    pub(crate) coulomb: Option<f64>,
    /// \[Nm s/rad\], \[N s/m\].
    pub(crate) viscous: Option<f64>,
}

impl Friction {
    /// Both, 0 where nothing is known.
    pub(crate) fn sizes(self) -> [f64; 2] {
        [self.coulomb, self.viscous].map(|own| own.unwrap_or(0.0))
    }
}

/// What the effects of a device give, joint by joint.
#[derive(Debug, Clone, Default)]
pub(crate) struct Effects<'d> {
    pub(crate) yields: Vec<Vec<Yield>>,
    pub(crate) friction: Vec<Friction>,
    /// How late each joint's reading is \[s\].
    pub(crate) encoder_delay_s: Vec<f64>,
    /// How late each external encoder is \[s\].
    pub(crate) external_delay_s: Vec<f64>,
    /// What MuJoCo has no means for.
    pub(crate) left_out: Vec<&'d DeviceEffect>,
    /// What is carried in part, or is no property of an arm.
    pub(crate) said: Vec<String>,
}

impl<'d> Effects<'d> {
    pub(crate) fn new(device: &'d Device) -> Self {
        let joints = device.joints.len();
        let mut effects = Self {
            yields: vec![Vec::new(); joints],
            friction: vec![Friction::default(); joints],
            encoder_delay_s: vec![0.0; joints],
            external_delay_s: vec![0.0; joints],
            ..Self::default()
        };
        for effect in &device.effects {
            if is_ahead(effect) {
                effects
                    .said
                    .push(format!("`{}` is left out: {AHEAD}", effect.label()));
            } else if effects.take(device, effect).is_none() {
                effects.left_out.push(effect);
            }
        }
        for joint in 0..joints {
            let compliance = device.compliance_rad_per_nm(joint);
            if compliance > 1.0 / RIGID {
                effects.yields[joint].push(Yield {
                    suffix: "_spring",
                    kind: YieldKind::Spring(1.0 / compliance),
                    is_before_encoder: false,
                });
            }
        }
        effects
    }

    /// Whether any channel is late.
    pub(crate) fn has_delays(&self) -> bool {
        let mut all = self.encoder_delay_s.iter().chain(&self.external_delay_s);
        all.any(|delay_s| *delay_s > 0.0)
    }

    /// Takes an effect; none where MuJoCo has no means for it.
    fn take(&mut self, device: &Device, effect: &DeviceEffect) -> Option<()> {
        let number = |keys: [&str; 2]| {
            keys.iter()
                .find_map(|key| effect.numbers.get(*key).copied())
        };
        let positive = |keys| number(keys).filter(|number| *number > 0.0 && number.is_finite());
        let late = || positive(["delay_s"; 2]).filter(|delay_s| *delay_s <= LATEST_S);
        let law = law(&effect.name)?;
        if law.0 == Hook::Timing {
            let delay_s = late()?;
            self.encoder_delay_s
                .iter_mut()
                .for_each(|own| *own = delay_s);
            return Some(());
        }
        // where a joint has no row whose value is its reading, its numbers are no row's
        let joint = effect.joint.filter(|joint| has_own_row(device, *joint))?;
        let kind = match law {
            (Hook::Torque, Form::Friction) => {
                let size = |number: FrictionNumber| {
                    let stated = number.stated(effect);
                    stated.filter(|number| *number > 0.0 && number.is_finite())
                };
                let friction = Friction {
                    coulomb: size(FrictionNumber::Coulomb),
                    viscous: size(FrictionNumber::Viscous),
                };
                if friction == Friction::default() {
                    return None;
                }
                self.friction[joint] = friction;
                if size(FrictionNumber::Stribeck).is_some() {
                    self.said.push(format!(
                        "`{}`: friction loss and damping have no Stribeck part, which is left out",
                        effect.label()
                    ));
                }
                return Some(());
            }
            (Hook::ExternalEncoder, Form::Delay) => {
                self.external_delay_s[joint] = late()?;
                return Some(());
            }
            (Hook::Transmission, Form::Spring) => {
                let stiffness = positive(["stiffness_nm_per_rad", "stiffness_n_per_m"])?;
                YieldKind::Spring(Some(stiffness).filter(|own| *own < RIGID)?)
            }
            (Hook::Transmission, Form::Play) => {
                YieldKind::Play(positive(["width_rad", "width_m"])?)
            }
            (Hook::Transmission, Form::Coupling) => {
                let from = number(["from_joint"; 2])?;
                let from = (0..device.joints.len()).find(|own| (own + 1) as f64 == from)?;
                let from =
                    Some(from).filter(|from| *from != joint && has_own_row(device, *from))?;
                let gain = number(["gain"; 2]).filter(|gain| gain.is_finite() && *gain != 0.0)?;
                YieldKind::Coupling(gain, from)
            }
            _ => return None,
        };
        let suffix = match kind {
            YieldKind::Spring(_) => "_cable",
            YieldKind::Play(_) => "_play",
            YieldKind::Coupling(..) => "_coupling",
        };
        // a second one of the same kind would need a name of its own
        if self.yields[joint].iter().any(|own| own.suffix == suffix) {
            return None;
        }
        self.yields[joint].push(Yield {
            suffix,
            kind,
            is_before_encoder: true,
        });
        Some(())
    }
}

/// Whether an effect is that of motor encoders that are ahead of the other sensors.
pub(crate) fn is_ahead(effect: &DeviceEffect) -> bool {
    let delay_s = effect.numbers.get("delay_s");
    law(&effect.name).is_some_and(|law| law.0 == Hook::Timing)
        && delay_s.is_some_and(|delay_s| *delay_s < 0.0)
}

/// Whether a row moves as the joint reads.
pub(crate) fn has_own_row(device: &Device, joint: usize) -> bool {
    let motion: Option<JointType> = device.joints.get(joint).map(|own| own.joint_type);
    let drive = device.own_row(joint).and_then(|row| device.drive(row));
    drive.is_some_and(|drive| drive.multiplier == 1.0 && Some(drive.motion) == motion)
}
