//! The suites of blind trials: which devices, effects and noises come at which index of a batch.

use anyhow::{Context, Result, bail};
use haptical_model::Device;

use crate::again::Again;
use crate::effects::{Group, KINDS, Kind};
use crate::loop_suites;
use crate::payload_suites;
use crate::random::Random;
use crate::rig::devices::{NOMINALS, Nominal};
use crate::rig::motion::MotionPlan;
use crate::trial::{Order, Trial, TrialId};
use crate::{arms, colour, moving, wrist};

/// A trial by which one it is and random numbers.
type Draws = fn(TrialId, &mut Random) -> Result<Trial>;

/// One row per suite: its name, the number of its streams, its place among the salts, its trials in a scored batch and in a
/// quick one, what it holds. A suite keeps its numbers when others are added.
macro_rules! suites {
    ($($variant:ident $name:literal $stream:literal $salt:literal $scored:literal $quick:literal $about:literal;)*) => {
        /// A suite.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Suite {
            $(#[doc = concat!("`", $name, "`: ", $about)] $variant,)*
        }

        impl Suite {
            /// All suites, in the order of a batch.
            pub const ALL: [Self; 28] = [$(Self::$variant,)*];

            /// Short name, what it holds, number of its streams and place among the salts, trials.
            const fn row(self) -> (&'static str, &'static str, [u64; 2], [u64; 2]) {
                match self {
                    $(Self::$variant => ($name, $about, [$stream, $salt], [$scored, $quick]),)*
                }
            }
        }
    };
}

suites! {
    Clean "s0" 1 0 300 6 "clean";
    Singles "s1" 2 1 300 11 "one strong effect";
    NearSingles "s1n" 3 2 150 1 "one effect, a tenth as strong";
    Withheld "s2" 4 3 150 2 "one strong effect, withheld from the catalogue";
    Unknown "s3" 5 4 100 2 "an effect in no catalogue";
    Pairs "s4" 6 5 100 1 "two effects";
    Ladder "s5" 7 6 70 1 "one effect, 1/100 to strong";
    Twins "s6" 8 7 40 1 "an effect with structural twins";
    Noise "s7" 9 8 60 1 "a pathology of the noise";
    Ablation "s8" 10 9 20 1 "ablation: kinematics only";
    Wrong "s10" 11 13 30 1 "100 times beyond the physical bound";
    Force "sf" 12 10 40 1 "an effect on force or torque";
    ForceWithheld "sfw" 13 11 45 1 "the same, withheld from the catalogue";
    ForceUnknown "sfu" 14 12 36 2 "an effect on force or torque in no catalogue";
    Payload "sp" 31 14 120 1 "torques alone, another payload from a run on";
    PayloadWithheld "spw" 32 15 40 1 "the same, withheld from the catalogue";
    PayloadSame "spc" 33 16 100 1 "torques alone, nothing changed between runs";
    Elastic "se" 15 17 100 1 "an arm that yields to its weight";
    Repeats "sr" 16 18 80 1 "postures with repeats";
    Moved "sm" 17 19 80 1 "runs with a moved tracker";
    Coloured "sc" 18 20 80 1 "noise with a memory";
    Wrist "sw" 19 21 100 1 "a wrist of several cables";
    Loop "sl" 20 22 96 1 "one strong effect, corrected and predicted";
    LoopPairs "slp" 21 23 50 1 "two effects, corrected and predicted";
    Absent "sla" 22 24 100 1 "clean, and an effect asked for";
    Moving "moving" 23 25 400 1 "arms that a controller moves";
    MovingMemory "moving-memory" 24 26 40 1 "the same, clean, noise with a memory";
    MovingAdmission "moving-admission" 25 27 140 2 "the same with faults of log, file and laws";
}

/// Streams of suites do not meet: suite number times this, plus the index.
const SUITE_STREAM: u64 = 1 << 40;

impl Suite {
    /// Short name: `s0`, `s1`, `s1n`, ...
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// What it holds.
    pub const fn about(self) -> &'static str {
        self.row().1
    }

    /// Number of its streams, and its place among the salts.
    pub const fn numbers(self) -> [u64; 2] {
        self.row().2
    }

    /// Trials of a scored batch, and of a quick check: each kind of clean recording once, a third of the strong effects,
    /// one or two of all other suites.
    pub const fn trials(self) -> [u64; 2] {
        self.row().3
    }

    /// Whether the diagnosis must not see the second recording: what it made of the first is tried on it.
    pub const fn keeps_second_back(self) -> bool {
        matches!(self, Self::Loop | Self::LoopPairs | Self::Absent)
    }

    /// Whether device file and logs may be such that a reader refuses them, which is an answer.
    pub const fn is_of_admission(self) -> bool {
        matches!(self, Self::MovingAdmission)
    }

    pub(crate) fn random(self, index: u64, batch_seed: u64) -> Random {
        Random::new(batch_seed, SUITE_STREAM * self.numbers()[0] + index)
    }

    pub(crate) const fn id(self, index: u64, seed: u64) -> TrialId {
        TrialId {
            suite: self.name(),
            index,
            seed,
        }
    }

    /// The suite of that name.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|suite| suite.name() == name);
        found.with_context(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            format!("there is no suite `{name}`; known are {known}")
        })
    }

    /// The trial at an index of the batch with a seed: the same for the same numbers, on any machine.
    pub fn draw(self, index: u64, batch_seed: u64) -> Result<Trial> {
        let (id, mut random) = (self.id(index, batch_seed), self.random(index, batch_seed));
        match self.draws() {
            Some(draw) => draw(id, &mut random),
            None => Ok(self.order(index, &mut random)?.make(id, &mut random)?.0),
        }
    }

    /// How a suite draws that has no orders.
    fn draws(self) -> Option<Draws> {
        Some(match self {
            Self::Elastic => arms::elastic,
            Self::Repeats => arms::repeats,
            Self::Moved => arms::moved,
            Self::Wrist => wrist::draw,
            Self::Absent => loop_suites::absent,
            Self::Moving => moving::draw,
            Self::MovingMemory => moving::with_memory,
            Self::MovingAdmission => moving::with_faults,
            _ => return None,
        })
    }

    /// The same trial with its device, for further recordings; none for suites that are not drawn as a device with effects
    /// and a motion of a hand.
    pub fn draw_again(self, index: u64, batch_seed: u64) -> Result<Option<(Trial, Again)>> {
        if self.draws().is_some() {
            return Ok(None);
        }
        let mut random = self.random(index, batch_seed);
        let order = self.order(index, &mut random)?;
        order
            .make(self.id(index, batch_seed), &mut random)
            .map(Some)
    }

    fn order(self, index: u64, random: &mut Random) -> Result<Order> {
        match self {
            Self::Singles | Self::Loop => single(index, random),
            Self::NearSingles => near(index, random),
            Self::Withheld => single(index, random).map(Order::withheld),
            Self::Unknown => strong(Group::Unknown, index, random),
            Self::Pairs | Self::LoopPairs => pair(index, random),
            Self::Ladder => ladder(index, random),
            Self::Twins => one_of(&named(&TWINS), index, 1.0, Joints::All, random),
            Self::Noise => strong(Group::Noise, index, random).map(Order::or_no_gap),
            Self::Ablation => ablation(index, random),
            Self::Force => strong(Group::Force, index, random),
            Self::ForceWithheld => {
                let mut kinds = of_group(Group::Force);
                kinds.retain(|kind| kind.name != TAKEN_UP);
                one_of(&kinds, index, 1.0, Joints::All, random).map(Order::withheld)
            }
            Self::ForceUnknown => strong(Group::ForceUnknown, index, random),
            Self::Wrong => beyond(index, random),
            Self::Payload => payload_suites::changed(index, random),
            Self::PayloadWithheld => payload_suites::changed(index, random).map(Order::withheld),
            Self::PayloadSame => payload_suites::unchanged(index, random),
            Self::Coloured => colour::order(index, random),
            // those that are drawn without an order too
            _ => clean(index, random),
        }
    }
}

/// Effects that can be recorded and identified a hundred times beyond their physical bound, with the
/// size that takes them there (a strong sag is beyond it already).
const BEYOND: [(&str, f64); 7] = [
    ("cable-sag", 2.4),
    ("thermal-drift", 100.0),
    ("cable-drift", 100.0),
    ("external-encoder-drift", 100.0),
    ("joint-drift", 100.0),
    ("capstan-compliance", 100.0),
    ("cable-hysteresis", 100.0),
];

/// Effects of which the base model takes up nine tenths and more: a tenth of them is lost.
const MOSTLY_ABSORBED: [&str; 3] = [
    "cable-pitch",
    "drum-out-of-round",
    "external-encoder-eccentricity",
];

/// A mass that the file does not have: the masses of the base model are fitted, so that it leaves no gap.
const TAKEN_UP: &str = "unbalanced-gravity";

/// Families whose members overlap too much to be put into one recording: by parts of their names.
const FAMILIES: [&[&str]; 6] = [
    &["latency", "lag"],
    &[
        "cable-exit",
        "cable-twist",
        "cable-zero",
        "cable-hysteresis",
    ],
    &["thermal", "drift", "creep"],
    &[
        "joint-compliance",
        "base-compliance",
        "tool-compliance",
        "tool-changed",
    ],
    &["count-loss", "slip"],
    &["backlash", "hysteresis", "windup"],
];

fn are_related(first: &str, second: &str) -> bool {
    let is_in = |family: &[&str], name: &str| family.iter().any(|part| name.contains(part));
    first == second
        || FAMILIES
            .iter()
            .any(|family| is_in(family, first) && is_in(family, second))
}

const TWINS: [&str; 9] = [
    "backlash",
    "hysteresis",
    "cable-exit-geometry",
    "cable-twist",
    "cable-zero-offset",
    "encoder-count-loss",
    "capstan-slip",
    "drum-out-of-round",
    "cable-pitch",
];

pub(crate) fn of_group(group: Group) -> Vec<&'static Kind> {
    KINDS.iter().filter(|kind| kind.group == group).collect()
}

pub(crate) fn named(names: &[&str]) -> Vec<&'static Kind> {
    let kinds = KINDS.iter().filter(|kind| names.contains(&kind.name));
    kinds.collect()
}

/// The 7-DOF device half of the time, the others a quarter each.
fn nominal(random: &mut Random) -> Nominal {
    NOMINALS[[0, 0, 1, 2][random.index(4)]]
}

/// Speeds and ranges differ a little; one recording in ten is slow, one in ten short.
fn vary(plan: &mut MotionPlan, random: &mut Random) {
    plan.pace_s *= random.uniform(0.85, 1.2);
    plan.reach = random.uniform(0.9, 0.97);
    match random.index(10) {
        0 => plan.pace_s *= 1.8,
        1 => plan.rows = plan.rows * 2 / 3,
        _ => {}
    }
}

/// A clean order for a random device.
pub(crate) fn of_device(random: &mut Random) -> Result<(Order, Device)> {
    let nominal = nominal(random);
    let device = nominal.device()?;
    let mut order = Order::clean(nominal, device.joints.len());
    vary(&mut order.plan, random);
    Ok((order, device))
}

/// Which joints may be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joints {
    /// All at which the kind can act.
    All,
    /// Of these, those with an external encoder, where there are any.
    Seen,
}

impl Joints {
    fn choices(self, kind: &Kind, device: &Device) -> Vec<usize> {
        let all = kind.joints(device);
        let has_encoder = |joint: &usize| device.joints[*joint].output_sd_rad().is_some();
        let seen: Vec<usize> = all.iter().copied().filter(has_encoder).collect();
        if self == Self::All || kind.is_whole() || seen.is_empty() {
            all
        } else {
            seen
        }
    }
}

/// The kinds in turn, each at a random joint; a device without a place for it is drawn again.
pub(crate) fn one_of(
    kinds: &[&'static Kind],
    index: u64,
    size: f64,
    joints: Joints,
    random: &mut Random,
) -> Result<Order> {
    let kind = kinds[(index % kinds.len().max(1) as u64) as usize];
    for _ in 0..100 {
        let (mut order, device) = of_device(random)?;
        if let Some(joint) = random.choose(&joints.choices(kind, &device)) {
            if kind.needs_two_runs() {
                order.plan.runs = 2;
                order.plan.rows /= 2;
            }
            order.effects.push((kind, joint, size));
            return Ok(order);
        }
    }
    bail!("`{}` has no place on device `any`", kind.name)
}

fn strong(group: Group, index: u64, random: &mut Random) -> Result<Order> {
    one_of(&of_group(group), index, 1.0, Joints::All, random)
}

fn single(index: u64, random: &mut Random) -> Result<Order> {
    strong(Group::Single, index, random)
}

/// Single effects that are not mostly absorbed.
pub(crate) fn visible() -> Vec<&'static Kind> {
    let mut kinds = of_group(Group::Single);
    kinds.retain(|kind| !MOSTLY_ABSORBED.contains(&kind.name));
    kinds
}

fn near(index: u64, random: &mut Random) -> Result<Order> {
    one_of(&visible(), index, 0.1, Joints::Seen, random)
}

pub(crate) fn clean(index: u64, random: &mut Random) -> Result<Order> {
    let (mut order, _) = of_device(random)?;
    let kind = index % 6;
    let labels = ["white", "white", "ar", "unequal", "outliers", "rounded"];
    let outputs = order.noise.output.iter_mut();
    for channel in outputs.chain([&mut order.noise.cable]) {
        match kind {
            2 => channel.autoregression = 0.5,
            3 => channel.factor = random.uniform(1.3, 2.5),
            4 => channel.outlier_share = 0.02,
            5 => channel.rounded = true,
            _ => {}
        }
    }
    order.label = Some(format!("clean-{}", labels[kind as usize]));
    Ok(order)
}

/// Two effects of different families, mostly at different joints or channels.
fn pair(index: u64, random: &mut Random) -> Result<Order> {
    let kinds = visible();
    let mut order = one_of(&kinds, index, 1.0, Joints::Seen, random)?;
    let device = order.nominal.device()?;
    let (first, first_joint, _) = order.effects[0];
    for _ in 0..1000 {
        let Some(second) = random.choose(&kinds) else {
            break;
        };
        let Some(joint) = random.choose(&Joints::Seen.choices(second, &device)) else {
            continue;
        };
        let is_apart = joint != first_joint || second.is_whole() != first.is_whole();
        let is_wanted = is_apart || random.unit() < 0.15;
        if is_wanted && !second.needs_two_runs() && !are_related(first.name, second.name) {
            order.effects.push((second, joint, 1.0));
            return Ok(order);
        }
    }
    bail!("`a second effect` has no place on device `{}`", device.name)
}

/// Seven sizes of one effect, then of the next: geometric from 1/100 to 1.
fn ladder(index: u64, random: &mut Random) -> Result<Order> {
    let step = (index % 7) as f64;
    let size = libm::pow(10.0, -2.0 + step / 3.0);
    one_of(&visible(), index / 7, size, Joints::Seen, random)
}

fn beyond(index: u64, random: &mut Random) -> Result<Order> {
    let (name, size) = BEYOND[(index % BEYOND.len() as u64) as usize];
    Ok(Order {
        implausible: true,
        ..one_of(&named(&[name]), index, size, Joints::Seen, random)?
    })
}

/// All transmission errors are missing from the model: those of any device, and larger ones at three
/// places.
fn ablation(index: u64, random: &mut Random) -> Result<Order> {
    let nominal = NOMINALS[[0, 2][(index % 2) as usize]];
    let device = nominal.device()?;
    let mut order = Order::clean(nominal, device.joints.len());
    vary(&mut order.plan, random);
    order.is_ablation = true;
    order.label = Some("kinematics-only".to_owned());
    for kind in of_group(Group::Base) {
        if let Some(joint) = random.choose(&kind.joints(&device)) {
            order.effects.push((kind, joint, 1.0));
        }
    }
    Ok(order)
}
