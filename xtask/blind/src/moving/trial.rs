//! One trial: an arm that was built, its controller, an effect, two recordings, the truth.

use std::collections::BTreeMap;

use anyhow::{Context, Result};

use crate::effects::theta;
use crate::moving::arms::{Arm, device_toml};
use crate::moving::change::{Change, Changes};
use crate::moving::kinds::Kind;
use crate::moving::laws::Drawn;
use crate::moving::motion::control::Design;
use crate::moving::motion::log::Ticks;
use crate::moving::plan::{Plan, Stratum, plan};
use crate::moving::scene::{Scene, placed};
use crate::moving::sensors::Sensors;
use crate::moving::sloppy::Sloppy;
use crate::planted::{Planted, Story};
use crate::random::Random;
use crate::rig::scene::CleanChannels;
use crate::trial::{Trial, TrialId};

/// A strong effect changes a torque by so much of its range in a fiftieth of the rows, or stands so far above the noise.
const STRONG_OF_RANGE: f64 = 0.03;
const STRONG_OVER_NOISE: f64 = 8.0;
/// Sizes that are tried until it does.
const SIZES: [f64; 3] = [1.0, 1.5, 2.2];

/// A trial with what its user knows besides.
#[derive(Debug)]
pub(crate) struct Moving {
    pub(crate) trial: Trial,
    pub(crate) arm: &'static Arm,
    pub(crate) design: Design,
    pub(crate) sensors: Sensors,
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at it"))]
    pub(crate) change: Changes,
}

/// The trial at an index of the suite `moving`.
pub(crate) fn draw(id: TrialId, random: &mut Random) -> Result<Trial> {
    let plan = plan(id.index, random);
    Ok(make(&plan, 0.0, id, random)?.trial)
}

/// The same of clean arms whose torque noise remembers a little.
pub(crate) fn with_memory(id: TrialId, random: &mut Random) -> Result<Trial> {
    let plan = Plan {
        stratum: Stratum::Clean,
        kinds: Vec::new(),
    };
    let memory = random.uniform(0.3, 0.7);
    Ok(make(&plan, memory, id, random)?.trial)
}

/// An arm that was built with its effects, and what it did on both courses.
pub(crate) struct Built {
    pub(crate) scene: Scene,
    pub(crate) effects: Vec<Drawn>,
    /// Of the effects, over that of strong ones.
    pub(crate) size: f64,
    pub(crate) found: Changes,
    /// Ticks of both recordings, with the rows that are shown.
    pub(crate) recorded: [(Ticks, Vec<usize>); 2],
}

/// Draws the effects of a plan at joints of a scene, as strong as the plan asks.
pub(crate) fn build(
    plan: &Plan,
    (scene, joints): (Scene, Vec<usize>),
    random: &mut Random,
) -> Result<Built> {
    let mut size = plan.stratum.size();
    let start = random.clone();
    let (mut effects, mut recorded, mut found) = (Vec::new(), None, Changes::default());
    for larger in SIZES {
        *random = start.clone();
        size = larger * plan.stratum.size();
        effects = scene.effects(&joints, &plan.kinds, size, random);
        let (ticks, changes) = scene.record(&effects, random);
        recorded = Some(ticks);
        found = changes;
        let is_sized = plan.kinds.iter().all(|kind| kind.is_sized);
        if plan.kinds.is_empty()
            || !is_sized
            || plan.stratum == Stratum::Weak
            || is_strong(&found, &scene)
        {
            break;
        }
    }
    Ok(Built {
        scene,
        effects,
        size,
        found,
        recorded: recorded.context("a recording has no size")?,
    })
}

pub(crate) fn make(plan: &Plan, memory: f64, id: TrialId, random: &mut Random) -> Result<Moving> {
    let built = build(plan, placed(plan, memory, random)?, random)?;
    let Built {
        scene,
        effects,
        size,
        found,
        recorded: [first, second],
    } = built;
    let sloppy = (plan.stratum == Stratum::Sloppy).then_some(Sloppy::of(id.index / 20));
    let read = |(ticks, rows): &(Ticks, Vec<usize>), other: &Ticks, random: &mut Random| {
        let mut ticks = ticks.clone();
        if let Some(way) = sloppy {
            way.replace(&mut ticks, other, scene.arm, random);
        }
        scene.sensors.read(scene.arm, &ticks, rows, random)
    };
    let log = read(&first, &second.0, random);
    let log2 = read(&second, &first.0, random);
    let device_toml = device_toml(scene.arm, scene.sensors.has_outputs);
    let story = story(plan, &effects, size, &found, &scene, sloppy);
    let mut truth = story.truth(id, BTreeMap::new());
    truth.no_gap_is_right = !plan.kinds.is_empty() && plan.kinds.iter().all(|kind| kind.hides);
    if plan.stratum == Stratum::Foreign {
        truth.joints = truth.effects.iter().map(|effect| effect.joint).collect();
        truth.joint = truth.joints.first().copied().flatten();
    }
    let trial = Trial::of(device_toml, [log, log2], CleanChannels::default(), truth)?;
    Ok(Moving {
        trial,
        arm: scene.arm,
        design: scene.design,
        sensors: scene.sensors,
        change: found,
    })
}

pub(crate) fn is_strong(found: &Changes, scene: &Scene) -> bool {
    let is = |change: &Change| {
        change.of_range >= STRONG_OF_RANGE || change.over_noise >= STRONG_OVER_NOISE
    };
    is(&found.arm) || (scene.sensors.has_command && is(&found.controller))
}

fn story(
    plan: &Plan,
    effects: &[Drawn],
    size: f64,
    found: &Changes,
    scene: &Scene,
    sloppy: Option<Sloppy>,
) -> Story {
    let planted =
        |(kind, effect): (&&'static Kind, &Drawn)| planted(kind, effect, size, found, scene);
    let labels: Vec<&str> = plan.kinds.iter().map(|kind| kind.label).collect();
    let label = match (plan.stratum, sloppy) {
        (_, Some(way)) => way.label().to_owned(),
        (Stratum::Clean, _) if scene.sensors.memory > 0.0 => "clean-memory".to_owned(),
        (Stratum::Clean, _) => "clean".to_owned(),
        _ => labels.join("+") + plan.stratum.suffix(),
    };
    let names = plan.kinds.iter().flat_map(|kind| kind.right.to_vec());
    let without = names.filter(|_| plan.stratum == Stratum::Withheld);
    let is_foreign = plan.stratum == Stratum::Foreign;
    let stems = effects.iter().filter_map(|effect| effect.joint);
    let stems = stems.filter(|_| is_foreign).map(theta);
    Story {
        label,
        device: scene.arm.name.to_owned(),
        planted: plan.kinds.iter().zip(effects).map(planted).collect(),
        without: without.collect(),
        depends_on: stems.collect(),
        is_unknown: is_foreign || sloppy.is_some(),
    }
}

/// An effect as it was put in.
pub(crate) fn planted(
    kind: &'static Kind,
    effect: &Drawn,
    size: f64,
    found: &Changes,
    scene: &Scene,
) -> Planted {
    let mut law = effect.numbers.clone();
    law.insert("size".to_owned(), size);
    let sides = [("arm", found.arm), ("controller", found.controller)];
    let heard = 1 + usize::from(scene.sensors.has_command);
    for (side, change) in sides.into_iter().take(heard) {
        law.insert(format!("change_{side}_over_noise"), change.over_noise);
        law.insert(format!("change_{side}_of_range"), change.of_range);
    }
    Planted {
        name: kind.right.first().copied().unwrap_or(kind.label),
        joint: effect.joint,
        right: kind.right.to_vec(),
        acceptable: kind.twins.to_vec(),
        size,
        law,
        ..Planted::default()
    }
}
