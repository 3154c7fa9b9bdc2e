//! Effects as they act: where each enters a recording, by which law, and which names are right for it.

pub(crate) mod added;
mod base;
mod cable;
mod drums;
mod forces;
mod foreign;
mod friction;
mod noises;
mod payload;
mod registry;
mod springs;
mod structure;
mod timing;
mod unknown;

use std::collections::BTreeMap;

use haptical_model::Device;

use crate::random::Random;
use crate::rig::geometry::Flex;
use crate::rig::noise::NoisePlan;
use crate::rig::scene::{CablePath, Scene};
use crate::truth::Event;

pub use registry::{Group, KINDS, Kind, kind};

/// What an effect is called and which answers to it are right.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Info {
    /// The name in the catalogue (docs/diagnosis.md), or one of its own for an effect that is in none.
    pub name: &'static str,
    /// Joint, from 0.
    pub joint: Option<usize>,
    /// Size relative to the strong one.
    pub size: f64,
    /// Names of which one must be answered; empty where the base model absorbs the effect.
    pub right: Vec<&'static str>,
    /// Names that may be answered besides.
    pub acceptable: Vec<&'static str>,
    /// Stems of the columns that an effect in no catalogue depends on: `theta2`, `t_s`, ...
    pub depends_on: Vec<String>,
}

/// Numbers of an effect in one recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facts {
    /// Parameters with the catalogue's names: effective values.
    pub parameters: BTreeMap<&'static str, f64>,
    /// Numbers of the law.
    pub law: BTreeMap<&'static str, f64>,
    /// Sudden events.
    pub events: Vec<Event>,
}

impl Facts {
    /// With a parameter of the catalogue.
    #[must_use]
    pub(crate) fn with(mut self, name: &'static str, value: f64) -> Self {
        self.parameters.insert(name, value);
        self
    }

    /// With a number of the law.
    #[must_use]
    pub(crate) fn law(mut self, name: &'static str, value: f64) -> Self {
        self.law.insert(name, value);
        self
    }
}

/// An effect: hooks in the order in which a recording comes about. Each does nothing unless it says so.
pub trait Effect: std::fmt::Debug + Send + Sync {
    /// Name and right answers.
    fn info(&self) -> &Info;

    /// Numbers of this recording.
    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        Facts::default()
    }

    /// Changes the true device (effects that the base model knows).
    fn device(&self, _device: &mut Device) {}

    /// Adds to what the transmission has to turn beyond the output angle \[rad\].
    fn upstream(&self, _scene: &Scene<'_>, _windup_rad: &mut [Vec<f64>]) {}

    /// Changes the motor-side readings \[rad\] before they are rounded to counts.
    fn motor(&self, _scene: &Scene<'_>, _reading_rad: &mut [Vec<f64>]) {}

    /// Changes the external encoders' readings \[rad\].
    fn external(&self, _scene: &Scene<'_>, _output_rad: &mut [Vec<f64>]) {}

    /// Changes the angles of the links behind the external encoders \[rad\].
    fn link(&self, _scene: &Scene<'_>, _angle_rad: &mut [Vec<f64>]) {}

    /// Flexes the structure.
    fn flex(&self, _scene: &Scene<'_>, _flex: &mut Flex) {}

    /// Replaces the straight path of the first cable \[m\].
    fn path(&self, _scene: &Scene<'_>, _path: &CablePath, _cable_m: &mut [f64]) {}

    /// Changes what the first cable's encoder reads \[m\].
    fn cable(&self, _scene: &Scene<'_>, _cable_m: &mut Vec<f64>) {}

    /// Changes the noise.
    fn noise(&self, _scene: &Scene<'_>, _plan: &mut NoisePlan) {}

    /// Changes the torque readings \[N m\].
    fn torque(&self, _scene: &Scene<'_>, _torque_nm: &mut [Vec<f64>]) {}

    /// Changes the force readings \[N\].
    fn force(&self, _scene: &Scene<'_>, _force_n: &mut [Vec<f64>; 3]) {}
}

/// What is at hand when an effect is drawn.
#[derive(Debug)]
pub struct Draw<'a> {
    /// The nominal device.
    pub device: &'a Device,
    /// The joint, from 0 (0 for effects without one).
    pub joint: usize,
    /// Size relative to the strong one.
    pub size: f64,
    /// Tells effects of one recording apart.
    pub tag: u64,
    /// Random numbers.
    pub random: &'a mut Random,
}

impl Draw<'_> {
    /// A strong amplitude, log-uniform over a factor of 3 around `middle`, times the size, with a
    /// random sign.
    pub(crate) fn signed(&mut self, middle: f64) -> f64 {
        self.random.sign() * self.amplitude(middle)
    }

    /// The same, positive.
    pub(crate) fn amplitude(&mut self, middle: f64) -> f64 {
        self.random.around(middle, 3.0) * self.size
    }

    /// Info of an effect at the joint.
    pub(crate) fn at_joint(&self, name: &'static str, right: &[&'static str]) -> Info {
        Info {
            joint: Some(self.joint),
            ..self.anywhere(name, right)
        }
    }

    /// Info of an effect without a joint.
    pub(crate) fn anywhere(&self, name: &'static str, right: &[&'static str]) -> Info {
        Info {
            name,
            joint: None,
            size: self.size,
            right: right.to_vec(),
            acceptable: Vec::new(),
            depends_on: Vec::new(),
        }
    }

    /// How much larger errors of this joint are than those of a joint with an external encoder: drives
    /// that only the cable sees are the wrist's, of up to 10 mrad (diagnosis study, items D4, D5).
    pub(crate) fn coarseness(&self) -> f64 {
        if self.has_external() { 1.0 } else { 4.0 }
    }

    /// Whether the joint has an external encoder.
    pub(crate) fn has_external(&self) -> bool {
        self.device.joints[self.joint].output_sd_rad().is_some()
    }
}
