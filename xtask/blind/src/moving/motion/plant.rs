//! The arm in motion: bodies, drives with their friction, what the effects add, and a fixed step of Runge and Kutta's.

use crate::moving::laws::{Drawn, Instant, Levels, Sliding};
use crate::moving::motion::rigid::{At, solve};
use crate::moving::motion::specimen::{Friction, Sense, Specimen};

/// Angles and rates: of the bodies, then of a motor that a soft drive has apart from its link.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    pub(crate) angle: Vec<f64>,
    pub(crate) rate: Vec<f64>,
}

pub(crate) struct Plant<'a> {
    pub(crate) specimen: &'a Specimen,
    pub(crate) effects: &'a [Drawn],
    pub(crate) state: State,
    /// Where each drive's bristle stands, and the motor's angle there.
    bristle: Vec<(f64, f64)>,
    work: Work,
}

#[derive(Debug, Clone, Default)]
struct Work {
    at: At,
    motor: Vec<f64>,
    added: Vec<f64>,
    stages: Vec<State>,
}

impl<'a> Plant<'a> {
    /// At rest at a posture of the drives; what swings hangs where its angles are 0.
    pub(crate) fn new(specimen: &'a Specimen, effects: &'a [Drawn], about: &[f64]) -> Self {
        let bodies = specimen.chain.links.len();
        let mut angle = about.to_vec();
        angle.resize(bodies, 0.0);
        angle.extend(specimen.soft.map(|soft| about[soft.joint]));
        let rate = vec![0.0; angle.len()];
        let bristle = about.iter().map(|angle| (0.0, *angle)).collect();
        let state = State { angle, rate };
        let work = Work {
            stages: vec![state.clone(); 5],
            ..Work::default()
        };
        Self {
            specimen,
            effects,
            state,
            bristle,
            work,
        }
    }

    fn bodies(&self) -> usize {
        self.specimen.chain.links.len()
    }

    /// Angle or rate of a drive's motor, of entries as [`State`] has them.
    pub(crate) fn motor(&self, entries: &[f64], joint: usize) -> f64 {
        match self.specimen.soft {
            Some(soft) if soft.joint == joint => entries[self.bodies()],
            _ => entries[joint],
        }
    }

    /// Friction of a drive, against its motion.
    pub(crate) fn friction(&self, sliding: &Sliding) -> f64 {
        let own = &self.specimen.friction[sliding.joint];
        let mut levels = Levels {
            coulomb: own.coulomb,
            viscous: own.viscous,
        };
        for effect in self.effects {
            (effect.friction)(sliding, &mut levels);
        }
        let (stood, from) = self.bristle[sliding.joint];
        let sense = own.sense.at(stood, sliding.angle - from, sliding.speed);
        levels.coulomb * sense + Friction::drag(levels.viscous, own.power, sliding.speed)
    }

    /// Accelerations at a state, with the torques of the motors held.
    pub(crate) fn accelerations(
        &mut self,
        time_s: f64,
        state: &State,
        drive: &[f64],
        out: &mut [f64],
    ) {
        let mut work = std::mem::take(&mut self.work);
        let bodies = self.bodies();
        let specimen = self.specimen;
        specimen
            .chain
            .at(&state.angle[..bodies], &state.rate[..bodies], &mut work.at);
        work.motor.clear();
        work.motor
            .extend((0..drive.len()).map(|joint| self.motor(&state.angle, joint)));
        work.added.clear();
        work.added.resize(bodies, 0.0);
        let instant = Instant {
            time_s,
            angle: &state.angle[..bodies],
            motor: &work.motor,
            at: &work.at,
        };
        for effect in self.effects {
            (effect.torque)(&instant, &mut work.added);
        }
        for joint in 0..bodies {
            out[joint] = work.added[joint] - work.at.bias[joint];
            if joint >= drive.len() {
                out[joint] -= specimen.swing_damping * state.rate[joint];
            }
        }
        for (joint, drive) in drive.iter().enumerate() {
            let sliding = Sliding {
                joint,
                time_s,
                angle: work.motor[joint],
                speed: self.motor(&state.rate, joint),
                drive: *drive,
            };
            let driven = drive - self.friction(&sliding);
            match specimen.soft {
                Some(soft) if soft.joint == joint => {
                    let through = soft.torque(
                        state.angle[bodies] - state.angle[joint],
                        state.rate[bodies] - state.rate[joint],
                    );
                    out[joint] += through;
                    out[bodies] = (driven - through) / specimen.armature[joint];
                }
                _ => {
                    out[joint] += driven;
                    work.at.mass[joint * bodies + joint] += specimen.armature[joint];
                }
            }
        }
        solve(&mut work.at.mass, &mut out[..bodies]);
        self.work = work;
    }

    /// One step with the torques of the motors held. Source: Hairer, Norsett & Wanner, *Solving Ordinary Differential Equations
    /// I*, section II.1, the classical method of order 4. A bristle is carried along by the travel since the step began.
    pub(crate) fn step(&mut self, time_s: f64, step_s: f64, drive: &[f64]) {
        const NODES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
        const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
        let mut stages = std::mem::take(&mut self.work.stages);
        let [first, rest @ ..] = &mut stages[..] else {
            return;
        };
        first.clone_from(&self.state);
        let (slopes, sum) = rest.split_at_mut(1);
        let (slope, [sum, at, ..]) = (&mut slopes[0], sum) else {
            return;
        };
        sum.clone_from(first);
        let count = first.angle.len();
        for (stage, node) in NODES.into_iter().enumerate() {
            let ahead = node * step_s;
            for entry in 0..count {
                let (rate, acceleration) = match stage {
                    0 => (0.0, 0.0),
                    _ => (slope.angle[entry], slope.rate[entry]),
                };
                at.angle[entry] = first.angle[entry] + ahead * rate;
                at.rate[entry] = first.rate[entry] + ahead * acceleration;
            }
            slope.angle.copy_from_slice(&at.rate);
            self.accelerations(time_s + ahead, at, drive, &mut slope.rate);
            for entry in 0..count {
                sum.angle[entry] += WEIGHTS[stage] * step_s * slope.angle[entry];
                sum.rate[entry] += WEIGHTS[stage] * step_s * slope.rate[entry];
            }
        }
        self.state.clone_from(sum);
        self.work.stages = stages;
        self.settle();
    }

    /// Carries the bristles to where the motors are now.
    fn settle(&mut self) {
        for joint in 0..self.bristle.len() {
            let angle = self.motor(&self.state.angle, joint);
            self.follow(joint, angle);
        }
    }

    /// Sets the state without a step, bristles carried along: to follow a motion that is known.
    pub(crate) fn follow(&mut self, joint: usize, angle: f64) {
        let (stood, from) = self.bristle[joint];
        let sense = self.specimen.friction[joint].sense;
        if matches!(sense, Sense::Bristle { .. }) {
            self.bristle[joint] = (sense.at(stood, angle - from, 0.0), angle);
        }
    }
}
