//! An arm that was built, with its controller and courses: where effects can act on it, and how it is recorded with them.

use anyhow::{Result, bail};
use haptical_model::kinematics::nalgebra::Vector3;

use crate::moving::arms::{Arm, SEVEN, SIX, SLIDER};
use crate::moving::change::{Changes, changes, every};
use crate::moving::kinds::{Kind, Need, Site};
use crate::moving::laws::{ANGLES_PER_S, Draw, Drawn};
use crate::moving::motion::control::{Asked, Design};
use crate::moving::motion::course::{Course, loads};
use crate::moving::motion::log::Ticks;
use crate::moving::motion::rigid::At;
use crate::moving::motion::run::Rig;
use crate::moving::motion::specimen::Specimen;
use crate::moving::plan::Plan;
use crate::moving::sensors::Sensors;
use crate::random::Random;

/// An arm with its controller and its two courses.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) arm: &'static Arm,
    specimen: Specimen,
    pub(crate) design: Design,
    pub(crate) sensors: Sensors,
    courses: [Course; 2],
    loads: Vec<Vec<f64>>,
    angles: Vec<Vec<f64>>,
    flange_m: Vec<Vector3<f64>>,
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
        for step in 0..(ANGLES_PER_S * self.sensors.duration_s) as usize {
            let asked = self.courses[0].at(step as f64 / ANGLES_PER_S);
            chain.at(&asked.angle, &asked.rate, &mut at);
            let own = loads(self.arm, &asked, &at);
            for (joint, load) in own.into_iter().enumerate() {
                self.loads[joint].push(load);
                self.angles[joint].push(asked.angle[joint]);
            }
            self.flange_m.push(at.flange().0);
        }
    }

    /// What is asked of the arm along the first course.
    pub(crate) fn asked(&self) -> Vec<Asked> {
        let steps = 0..(ANGLES_PER_S * self.sensors.duration_s) as usize;
        steps
            .map(|step| self.courses[0].at(step as f64 / ANGLES_PER_S))
            .collect()
    }

    /// Joints (from 0) at which a kind can act.
    pub(crate) fn joints(&self, kind: &Kind) -> Vec<usize> {
        kind.joints(self.arm, &self.loads)
    }

    /// Effects at their joints; two do not share one.
    pub(crate) fn effects(
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
    pub(crate) fn record(
        &self,
        effects: &[Drawn],
        random: &mut Random,
    ) -> ([(Ticks, Vec<usize>); 2], Changes) {
        let mut plain = self.specimen.clone();
        for effect in effects {
            (effect.prepare)(&mut plain);
        }
        let mut built = plain.clone();
        for effect in effects {
            (effect.build)(&mut built);
        }
        let rig = Rig {
            arm: self.arm,
            specimen: &built,
            design: &self.design,
            effects,
            steps: if built.soft.is_some() { 4 } else { 2 },
        };
        let recorded = self.courses.each_ref().map(|course| {
            let mut ticks = rig.run(course);
            for effect in effects {
                (effect.readings)(&mut ticks);
            }
            let every = every(self.sensors.rate_hz);
            let mut rows: Vec<usize> = (0..ticks.len()).step_by(every).collect();
            for effect in effects {
                (effect.rows)(&mut rows, random);
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

/// Arms to draw from: the one of six joints and that of seven twice in five each.
pub(crate) const ARMS: [&Arm; 5] = [&SIX, &SEVEN, &SIX, &SEVEN, &SLIDER];

/// Draws an arm on which every kind has a joint of its own.
pub(crate) fn placed(plan: &Plan, memory: f64, random: &mut Random) -> Result<(Scene, Vec<usize>)> {
    placed_on(&ARMS, plan, memory, random)
}

/// The same of one of these arms.
pub(crate) fn placed_on(
    arms: &[&'static Arm],
    plan: &Plan,
    memory: f64,
    random: &mut Random,
) -> Result<(Scene, Vec<usize>)> {
    let needs: Vec<Need> = plan.kinds.iter().map(|kind| kind.need).collect();
    for _ in 0..50 {
        let scene = Scene::draw(arms[random.index(arms.len())], memory, &needs, random);
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
    let labels: Vec<&str> = plan.kinds.iter().map(|kind| kind.label).collect();
    bail!("`{}` has no place on device `any arm`", labels.join(", "))
}
