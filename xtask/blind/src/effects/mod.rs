//! Effects as they act: where each enters a recording, by which law, and which names are right for it.

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

    #[must_use]
    pub(crate) fn laws(mut self, numbers: impl IntoIterator<Item = (&'static str, f64)>) -> Self {
        self.law.extend(numbers);
        self
    }

    #[must_use]
    pub(crate) fn law(mut self, name: &'static str, value: f64) -> Self {
        self.law.insert(name, value);
        self
    }

    /// With events; the time and the size of one alone are parameters.
    #[must_use]
    pub(crate) fn happening(mut self, size_name: &'static str, events: Vec<Event>) -> Self {
        if let [event] = &events[..] {
            self = self
                .with(size_name, event.size)
                .with("time_s", event.time_s);
        }
        self.events = events;
        self
    }
}

/// Columns that effects change, in the order in which a recording comes about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// What the transmission has to turn beyond the output angle \[rad\].
    Upstream,
    /// Motor-side readings \[rad\] before they are rounded to counts.
    Motor,
    /// External encoders' readings \[rad\].
    External,
    /// Angles of the links behind the external encoders \[rad\].
    Link,
    /// What the first cable's encoder reads \[m\].
    Cable,
    /// Torque readings \[N m\].
    Torque,
    /// Force readings \[N\].
    Force,
}

/// Changes something of a recording.
type Change<T> = Box<dyn Fn(&Scene<'_>, &mut T) + Send + Sync>;
/// Makes lengths of the first cable from its straight path.
type OtherPath = Box<dyn Fn(&Scene<'_>, &CablePath, &mut [f64]) + Send + Sync>;

pub(crate) enum Act {
    /// Changes the true device (effects that the base model knows).
    Device(Box<dyn Fn(&mut Device) + Send + Sync>),
    Columns(Stage, Change<[Vec<f64>]>),
    Flex(Change<Flex>),
    /// Replaces the straight path of the first cable \[m\].
    Path(OtherPath),
    Noise(Change<NoisePlan>),
}

/// An effect: its name and right answers, its numbers in a recording, and what it does as one comes about.
pub struct Effect {
    /// Name and right answers.
    pub info: Info,
    facts: Box<dyn Fn(&Scene<'_>) -> Facts + Send + Sync>,
    act: Act,
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = formatter.debug_struct("Effect");
        shown.field("info", &self.info).finish_non_exhaustive()
    }
}

/// Numbers that are the same in every recording.
pub(crate) fn fixed(facts: Facts) -> impl Fn(&Scene<'_>) -> Facts + Send + Sync {
    move |_| facts.clone()
}

impl Effect {
    pub(crate) fn new(
        info: Info,
        facts: impl Fn(&Scene<'_>) -> Facts + Send + Sync + 'static,
        act: Act,
    ) -> Self {
        let facts = Box::new(facts);
        Self { info, facts, act }
    }

    /// Changes columns of one stage, by numbers that are the same in every recording.
    pub(crate) fn of_columns(
        info: Info,
        stage: Stage,
        facts: Facts,
        act: impl Fn(&Scene<'_>, &mut [Vec<f64>]) + Send + Sync + 'static,
    ) -> Self {
        Self::new(info, fixed(facts), Act::Columns(stage, Box::new(act)))
    }

    /// Adds what `law` says, sample by sample, to the signal of the effect's joint, or to the cable's reading, in the signal's
    /// unit. Upstream the law is given the output angle, and a positive deviation lets the motor lead.
    pub(crate) fn added(
        info: Info,
        stage: Stage,
        facts: impl Fn(&Scene<'_>) -> Facts + Send + Sync + 'static,
        law: impl Fn(&Scene<'_>, &[f64]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        let column = info.joint.unwrap_or(0);
        let add = move |scene: &Scene<'_>, columns: &mut [Vec<f64>]| {
            let deviation = match stage {
                Stage::Upstream => law(scene, &scene.motion.angle_rad[column]),
                _ => law(scene, &columns[column]),
            };
            for (value, extra) in columns[column].iter_mut().zip(deviation) {
                *value += extra;
            }
        };
        Self::new(info, facts, Act::Columns(stage, Box::new(add)))
    }

    /// Numbers of this recording.
    pub fn facts(&self, scene: &Scene<'_>) -> Facts {
        (self.facts)(scene)
    }

    /// Changes the true device.
    pub fn device(&self, device: &mut Device) {
        if let Act::Device(act) = &self.act {
            act(device);
        }
    }

    pub(crate) fn columns(&self, stage: Stage, scene: &Scene<'_>, columns: &mut [Vec<f64>]) {
        if let Act::Columns(of, act) = &self.act
            && *of == stage
        {
            act(scene, columns);
        }
    }

    pub(crate) fn flex(&self, scene: &Scene<'_>, flex: &mut Flex) {
        if let Act::Flex(act) = &self.act {
            act(scene, flex);
        }
    }

    /// Changes the length of the first cable along its path.
    pub(crate) fn path(&self, scene: &Scene<'_>, path: &CablePath, cable_m: &mut [f64]) {
        if let Act::Path(act) = &self.act {
            act(scene, path, cable_m);
        }
    }

    pub(crate) fn noise(&self, scene: &Scene<'_>, plan: &mut NoisePlan) {
        if let Act::Noise(act) = &self.act {
            act(scene, plan);
        }
    }
}

/// Stem of a joint's column.
pub(crate) fn theta(joint: usize) -> String {
    format!("theta{}", joint + 1)
}

/// The names that are right of an effect in no catalogue.
pub(crate) const UNKNOWN: [&str; 1] = ["unknown"];

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

    pub(crate) fn has_external(&self) -> bool {
        self.device.joints[self.joint].output_sd_rad().is_some()
    }

    pub(crate) fn other_joint(&mut self) -> usize {
        let joints = 0..self.device.joints.len();
        let others: Vec<usize> = joints.filter(|joint| *joint != self.joint).collect();
        self.random.choose(&others).unwrap_or(0)
    }
}
