//! Faults of logs, device files and arms at which a verdict may not be what it is on a sound log: friction next to an effect,
//! readings that are none, a wrong unit, a wrong zero, a wrong description, too short a log, another arm.

mod description;
mod dropouts;
mod felt;
mod other;
mod partial;
mod readings;
mod short;

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use haptical_model::Recording;

use crate::moving::arms::{Arm, device_toml};
use crate::moving::kinds::{Kind, NAMED};
use crate::moving::plan::{Plan, Stratum};
use crate::moving::scene::{ARMS, Scene, placed_on};
use crate::moving::trial::{Built, build, planted};
use crate::planted::{Planted, Story};
use crate::random::Random;
use crate::rig::scene::CleanChannels;
use crate::trial::{Trial, TrialId};
use crate::truth::Besides;

#[cfg(test)]
pub(crate) use felt::largest_apart;
#[cfg(test)]
pub(crate) use readings::with_zero;

/// What is wrong in a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    Partial,
    Dropouts,
    Scale,
    Zero,
    Description,
    Short,
    OtherArm,
}

/// One after the other.
pub(crate) const FAULTS: [Fault; 7] = [
    Fault::Partial,
    Fault::Dropouts,
    Fault::Scale,
    Fault::Zero,
    Fault::Description,
    Fault::Short,
    Fault::OtherArm,
];

/// The fault of a trial, and how many of the same kind come before it.
pub(crate) fn fault(index: u64) -> (Fault, usize) {
    let count = FAULTS.len() as u64;
    (FAULTS[(index % count) as usize], (index / count) as usize)
}

/// The trial at an index of the suite `moving-admission`.
pub(crate) fn draw(id: TrialId, random: &mut Random) -> Result<Trial> {
    let (fault, number) = fault(id.index);
    let draw = match fault {
        Fault::Partial => partial::draw,
        Fault::Dropouts => dropouts::draw,
        Fault::Scale => readings::scale,
        Fault::Zero => readings::zero,
        Fault::Description => description::draw,
        Fault::Short => short::draw,
        Fault::OtherArm => other::draw,
    };
    draw(number, id, random)
}

/// Strong effects of masses and sensors next to which a fault is put, in turn.
const EFFECTS: [&str; 6] = [
    "payload",
    "torque-gain",
    "link-inertia",
    "encoder-latency",
    "gravity-spring",
    "torque-offset",
];

fn effect(number: usize) -> Result<&'static Kind> {
    let label = EFFECTS[number % EFFECTS.len()];
    let mut kinds = NAMED.iter();
    kinds
        .find(|kind| kind.label == label)
        .with_context(|| format!("there is no effect `{label}` of moving arms"))
}

/// A plan of nothing, or of one strong effect.
fn plan(kind: Option<&'static Kind>) -> Plan {
    Plan {
        stratum: match kind {
            Some(_) => Stratum::Strong,
            None => Stratum::Clean,
        },
        kinds: kind.into_iter().collect(),
    }
}

/// One of these arms, clean or with a strong effect, and what it did.
fn built(arms: &[&'static Arm], kind: Option<&'static Kind>, random: &mut Random) -> Result<Built> {
    let plan = plan(kind);
    build(&plan, placed_on(arms, &plan, 0.0, random)?, random)
}

/// Any arm, clean or with a strong effect.
fn any(kind: Option<&'static Kind>, random: &mut Random) -> Result<Built> {
    built(&ARMS, kind, random)
}

impl Built {
    /// What was put in with a plan of nothing or of one effect.
    fn planted(&self, kind: Option<&'static Kind>) -> Vec<Planted> {
        let pairs = kind.into_iter().zip(&self.effects);
        pairs
            .map(|(kind, effect)| planted(kind, effect, self.size, &self.found, &self.scene))
            .collect()
    }

    fn logs(&self, random: &mut Random) -> [Recording; 2] {
        let scene = &self.scene;
        let read =
            |(ticks, rows): &(_, Vec<usize>)| scene.sensors.read(scene.arm, ticks, rows, random);
        self.recorded.each_ref().map(read)
    }
}

/// What a trial is about.
#[derive(Debug, Default)]
struct Tale {
    label: String,
    planted: Vec<Planted>,
    is_unknown: bool,
    no_gap_is_right: bool,
    besides: Besides,
}

impl Tale {
    /// The trial of the arm that `scene` has as its device file.
    fn trial(self, id: TrialId, scene: &Scene, logs: [Recording; 2]) -> Result<Trial> {
        self.trial_of(id, scene.arm, scene.sensors.has_outputs, logs)
    }

    fn trial_of(
        self,
        id: TrialId,
        arm: &Arm,
        has_outputs: bool,
        logs: [Recording; 2],
    ) -> Result<Trial> {
        let story = Story {
            label: self.label,
            device: arm.name.to_owned(),
            planted: self.planted,
            is_unknown: self.is_unknown,
            ..Story::default()
        };
        let mut truth = story.truth(id, BTreeMap::new());
        truth.no_gap_is_right = self.no_gap_is_right;
        truth.besides = self.besides;
        let device_toml = device_toml(arm, has_outputs);
        Trial::of(device_toml, logs, CleanChannels::default(), truth)
    }
}

/// Texts of their own.
fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}
