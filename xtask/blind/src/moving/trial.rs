//! One trial: an arm that was built, its controller, an effect, two recordings, the truth.

use haptical_model::Device;

use crate::error::BlindError;
use crate::moving::arms::{Arm, SEVEN, SIX, SLIDER, device_toml};
use crate::moving::change::{Change, Changes, changes, every};
use crate::moving::control::Design;
use crate::moving::course::{Course, loads};
use crate::moving::kinds::{Kind, Need, Site};
use crate::moving::laws::{Draw, Drawn, Law};
use crate::moving::log::Ticks;
use crate::moving::plan::{Plan, Stratum, plan};
use crate::moving::rigid::At;
use crate::moving::run::Rig;
use crate::moving::sensors::Sensors;
use crate::moving::specimen::Specimen;
use crate::planted::{Planted, Story};
use crate::random::Random;
use crate::rig::scene::CleanChannels;
use crate::trial::Trial;

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
    /// What its effects change.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests look at it"))]
    pub(crate) change: Changes,
}

/// The trial at an index of the suite `moving`.
pub(crate) fn draw(
    suite: &str,
    index: u64,
    seed: u64,
    random: &mut Random,
) -> Result<Trial, BlindError> {
    let plan = plan(index, random);
    Ok(make(&plan, 0.0, (suite, index, seed), random)?.trial)
}

/// The same of clean arms whose torque noise remembers a little.
pub(crate) fn with_memory(
    suite: &str,
    index: u64,
    seed: u64,
    random: &mut Random,
) -> Result<Trial, BlindError> {
    let plan = Plan {
        stratum: Stratum::Clean,
        kinds: Vec::new(),
    };
    let memory = random.uniform(0.3, 0.7);
    Ok(make(&plan, memory, (suite, index, seed), random)?.trial)
}

/// An arm with its controller and its two courses.
struct Scene {
    arm: &'static Arm,
    specimen: Specimen,
    design: Design,
    sensors: Sensors,
    courses: [Course; 2],
    loads: Vec<Vec<f64>>,
    angles: Vec<Vec<f64>>,
    flange_m: Vec<haptical_model::kinematics::nalgebra::Vector3<f64>>,
}

impl Scene {
    fn draw(arm: &'static Arm, memory: f64, needs: &[Need], random: &mut Random) -> Self {
        let duration_s = libm::round(random.uniform(15.0, 30.0));
        let rate_hz = random
            .choose(&[100.0, 200.0, 200.0, 250.0, 500.0])
            .unwrap_or(200.0);
        let share = random.uniform(0.003, 0.01);
        let needs = |need: Need| needs.contains(&need);
        let has_command = random.unit() < 0.7 || needs(Need::Command);
        let has_outputs = (random.unit() < 0.15 || needs(Need::Outputs)) && !needs(Need::NoOutputs);
        let sensors = Sensors {
            rate_hz,
            duration_s,
            noise: arm.axes.iter().map(|axis| share * axis.range).collect(),
            memory,
            has_command,
            has_outputs,
        };
        let first = Course::harmonics(arm, duration_s, random);
        let second = match random.unit() < 0.25 {
            true => Course::postures(arm, duration_s, random),
            false => Course::harmonics(arm, duration_s, random),
        };
        let design = Design::draw(arm, &first.about, random);
        let mut scene = Self {
            arm,
            specimen: Specimen::draw(arm, random),
            design,
            sensors,
            courses: [first, second],
            loads: vec![Vec::new(); arm.count()],
            angles: vec![Vec::new(); arm.count()],
            flange_m: Vec::new(),
        };
        scene.look_along();
        scene
    }

    /// Torques, angles and places of the flange along the first course.
    fn look_along(&mut self) {
        let chain = self.arm.chain();
        let mut at = At::default();
        for step in 0..(20.0 * self.sensors.duration_s) as usize {
            let asked = self.courses[0].at(0.05 * step as f64);
            chain.at(&asked.angle, &asked.rate, &mut at);
            let own = loads(self.arm, &asked, &at);
            for (joint, load) in own.into_iter().enumerate() {
                self.loads[joint].push(load);
                self.angles[joint].push(asked.angle[joint]);
            }
            self.flange_m.push(at.flange().0);
        }
    }

    /// Effects at their joints; two do not share one.
    fn effects(
        &self,
        joints: &[usize],
        kinds: &[&'static Kind],
        size: f64,
        random: &mut Random,
    ) -> Vec<Drawn> {
        let draw = |(kind, joint): (&&'static Kind, &usize)| {
            (kind.draw)(&mut Draw {
                arm: self.arm,
                joint: *joint,
                size,
                duration_s: self.sensors.duration_s,
                loads: &self.loads,
                angles: &self.angles,
                flange_m: &self.flange_m,
                random,
            })
        };
        kinds.iter().zip(joints).map(draw).collect()
    }

    /// Records both courses: ticks with the rows that are shown, and what the effects change in the first one.
    fn record(
        &self,
        effects: &[Drawn],
        random: &mut Random,
    ) -> ([(Ticks, Vec<usize>); 2], Changes) {
        let mut plain = self.specimen.clone();
        for effect in effects {
            effect.law.prepare(&mut plain);
        }
        let mut built = plain.clone();
        for effect in effects {
            effect.law.build(&mut built);
        }
        let laws: Vec<&dyn Law> = effects.iter().map(|effect| &*effect.law).collect();
        let rig = Rig {
            arm: self.arm,
            specimen: &built,
            design: &self.design,
            laws,
            steps: if built.soft.is_some() { 4 } else { 2 },
        };
        let recorded = self.courses.each_ref().map(|course| {
            let mut ticks = rig.run(course);
            for effect in effects {
                effect.law.readings(&mut ticks);
            }
            let every = every(self.sensors.rate_hz);
            let mut rows: Vec<usize> = (0..ticks.len()).step_by(every).collect();
            for effect in effects {
                effect.law.rows(&mut rows, random);
            }
            (ticks, rows)
        });
        let (ticks, rows) = &recorded[0];
        let rate_hz = self.sensors.rate_hz;
        let found = changes(
            self.arm,
            &plain,
            &self.design,
            ticks,
            rows,
            rate_hz,
            &self.sensors.noise,
        );
        (recorded, found)
    }
}

/// An arm: the one of six joints and that of seven twice in five each.
fn arm(random: &mut Random) -> &'static Arm {
    [&SIX, &SEVEN, &SIX, &SEVEN, &SLIDER][random.index(5)]
}

/// Draws an arm on which every kind has a joint of its own.
fn placed(
    plan: &Plan,
    memory: f64,
    random: &mut Random,
) -> Result<(Scene, Vec<usize>), BlindError> {
    let needs: Vec<Need> = plan.kinds.iter().map(|kind| kind.need).collect();
    for _ in 0..50 {
        let scene = Scene::draw(arm(random), memory, &needs, random);
        let mut joints = Vec::new();
        for kind in &plan.kinds {
            let mut free = kind.joints(scene.arm, &scene.loads);
            free.retain(|joint| kind.site == Site::Whole || !joints.contains(joint));
            let Some(joint) = random.choose(&free) else {
                break;
            };
            joints.push(joint);
        }
        if joints.len() == plan.kinds.len() {
            return Ok((scene, joints));
        }
    }
    Err(BlindError::NoPlace {
        effect: plan
            .kinds
            .iter()
            .map(|kind| kind.label)
            .collect::<Vec<_>>()
            .join(", "),
        device: "any arm".to_owned(),
    })
}

/// Makes a trial.
pub(crate) fn make(
    plan: &Plan,
    memory: f64,
    (suite, index, seed): (&str, u64, u64),
    random: &mut Random,
) -> Result<Moving, BlindError> {
    let (scene, joints) = placed(plan, memory, random)?;
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
    let [first, second] = recorded.ok_or_else(|| BlindError::NoPlace {
        effect: "a recording".to_owned(),
        device: scene.arm.name.to_owned(),
    })?;
    let sloppy = (plan.stratum == Stratum::Sloppy).then(|| index / 20 % 3);
    let read = |(ticks, rows): &(Ticks, Vec<usize>), other: &Ticks, random: &mut Random| {
        let mut ticks = ticks.clone();
        if let Some(way) = sloppy {
            replace_torques(&mut ticks, other, way, scene.arm, random);
        }
        scene.sensors.read(scene.arm, &ticks, rows, random)
    };
    let log = read(&first, &second.0, random);
    let log2 = read(&second, &first.0, random);
    let device_toml = device_toml(scene.arm, scene.sensors.has_outputs);
    let device = Device::from_toml(&device_toml, scene.arm.name)?.device;
    let story = story(plan, &effects, size, &found, &scene, sloppy);
    let mut truth = story.truth(suite, index, seed, std::collections::BTreeMap::new());
    truth.no_gap_is_right = !plan.kinds.is_empty() && plan.kinds.iter().all(|kind| kind.hides);
    for effect in &mut truth.effects {
        effect.size = size;
    }
    if plan.stratum == Stratum::Foreign {
        truth.joints = truth.effects.iter().map(|effect| effect.joint).collect();
        truth.joint = truth.joints.first().copied().flatten();
    }
    let trial = Trial {
        device,
        device_toml,
        model_toml: None,
        log,
        log2,
        clean2: CleanChannels::default(),
        without: truth.without.clone(),
        asked: None,
        truth,
    };
    Ok(Moving {
        trial,
        arm: scene.arm,
        design: scene.design,
        sensors: scene.sensors,
        change: found,
    })
}

fn is_strong(found: &Changes, scene: &Scene) -> bool {
    let is = |change: &Change| {
        change.of_range >= STRONG_OF_RANGE || change.over_noise >= STRONG_OVER_NOISE
    };
    is(&found.arm) || (scene.sensors.has_command && is(&found.controller))
}

/// Ways in which torques are of something else.
const SLOPPY: [&str; 3] = [
    "torques-of-another-run",
    "torques-of-other-joints",
    "torques-of-nothing",
];

/// Puts something unrelated in the place of the torques.
fn replace_torques(ticks: &mut Ticks, other: &Ticks, way: u64, arm: &Arm, random: &mut Random) {
    match way {
        0 => ticks.torque.clone_from(&other.torque),
        1 => {
            // each joint has the torque of another one, in shares of its range
            let count = arm.count();
            let shares: Vec<Vec<f64>> = (0..count)
                .map(|joint| {
                    ticks.torque[joint]
                        .iter()
                        .map(|own| own / arm.axes[joint].range)
                        .collect()
                })
                .collect();
            for joint in 0..count {
                let from = &shares[(joint + 2) % count];
                ticks.torque[joint] = from
                    .iter()
                    .map(|share| share * arm.axes[joint].range)
                    .collect();
            }
        }
        _ => {
            for (joint, torque) in ticks.torque.iter_mut().enumerate() {
                let tones: Vec<[f64; 3]> = (0..6)
                    .map(|_| {
                        [
                            random.around(0.5, 10.0),
                            random.uniform(0.02, 0.12),
                            random.phase_rad(),
                        ]
                    })
                    .collect();
                let level = arm.axes[joint].range;
                for (torque, time_s) in torque.iter_mut().zip(&ticks.time_s) {
                    let tone = |[hz, size, phase]: &[f64; 3]| {
                        size * libm::sin(std::f64::consts::TAU * hz * time_s + phase)
                    };
                    *torque = level * tones.iter().map(tone).sum::<f64>();
                }
            }
        }
    }
}

fn story(
    plan: &Plan,
    effects: &[Drawn],
    size: f64,
    found: &Changes,
    scene: &Scene,
    sloppy: Option<u64>,
) -> Story {
    let planted = |(kind, effect): (&&'static Kind, &Drawn)| {
        let mut law = effect.numbers.clone();
        law.insert("size".to_owned(), size);
        let heard = scene
            .sensors
            .has_command
            .then_some(("controller", found.controller));
        for (side, change) in [("arm", found.arm)].into_iter().chain(heard) {
            law.insert(format!("change_{side}_over_noise"), change.over_noise);
            law.insert(format!("change_{side}_of_range"), change.of_range);
        }
        Planted {
            name: kind.right.first().copied().unwrap_or(kind.label),
            joint: effect.joint,
            right: kind.right.to_vec(),
            acceptable: Vec::new(),
            law,
        }
    };
    let labels: Vec<&str> = plan.kinds.iter().map(|kind| kind.label).collect();
    let label = match (plan.stratum, sloppy) {
        (_, Some(way)) => SLOPPY[way as usize].to_owned(),
        (Stratum::Clean, _) if scene.sensors.memory > 0.0 => "clean-memory".to_owned(),
        (Stratum::Clean, _) => "clean".to_owned(),
        _ => labels.join("+") + plan.stratum.suffix(),
    };
    let without = match plan.stratum {
        Stratum::Withheld => plan
            .kinds
            .iter()
            .flat_map(|kind| kind.right.to_vec())
            .collect(),
        _ => Vec::new(),
    };
    let is_foreign = plan.stratum == Stratum::Foreign;
    let stems = effects
        .iter()
        .filter(|_| is_foreign)
        .filter_map(|effect| effect.joint);
    Story {
        label,
        device: scene.arm.name.to_owned(),
        planted: plan.kinds.iter().zip(effects).map(planted).collect(),
        without,
        depends_on: stems.map(|joint| format!("theta{}", joint + 1)).collect(),
        is_unknown: is_foreign || sloppy.is_some(),
    }
}
