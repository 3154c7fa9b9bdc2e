//! Controllers of the arms, at 1 kHz: stiffness and damping with the nominal gravity, or the computed torque.

use crate::moving::arms::Arm;
use crate::moving::motion::rigid::{At, Chain};
use crate::random::Random;

pub(crate) const TICKS_PER_S: f64 = 1000.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `kp (c - q) + kd (c' - q') + g(q)`.
    Gravity,
    /// `M(q) (c'' + kp (c - q) + kd (c' - q')) + h(q, q')`. Source: Craig, *Introduction to Robotics*, 3rd ed., section 10.4.
    Computed,
}

/// A controller's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Design {
    pub(crate) kind: Kind,
    /// Of [`Kind::Gravity`] torque per angle, of [`Kind::Computed`] acceleration per angle.
    pub(crate) stiffness: Vec<f64>,
    pub(crate) damping: Vec<f64>,
    /// Corner of the filter of the measured speed \[Hz\].
    pub(crate) lowpass_hz: f64,
    pub(crate) range: Vec<f64>,
    chain: Chain,
    armature: Vec<f64>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Asked {
    pub(crate) angle: Vec<f64>,
    pub(crate) rate: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

impl Design {
    /// Draws one for an arm that moves about a posture.
    pub(crate) fn draw(arm: &Arm, about: &[f64], random: &mut Random) -> Self {
        let chain = arm.chain();
        let armature: Vec<f64> = arm.axes.iter().map(|axis| axis.armature).collect();
        let kind = if random.unit() < 0.6 {
            Kind::Gravity
        } else {
            Kind::Computed
        };
        let mut at = At::default();
        chain.at(about, &vec![0.0; arm.count()], &mut at);
        let per_s = random.uniform(28.0, 42.0);
        let ratio = random.uniform(0.8, 1.1);
        let inertias = (0..arm.count()).map(|joint| match kind {
            Kind::Gravity => armature[joint] + at.mass[joint * arm.count() + joint],
            Kind::Computed => 1.0,
        });
        // gains are round numbers
        let round = |value: f64| {
            let digits = libm::pow(10.0, 1.0 - libm::floor(libm::log10(value)));
            libm::round(value * digits) / digits
        };
        let gains = inertias.map(|inertia| {
            let stiffness = round(inertia * per_s * per_s);
            (stiffness, round(2.0 * ratio * per_s * inertia))
        });
        let (stiffness, damping) = gains.unzip();
        Self {
            kind,
            stiffness,
            damping,
            lowpass_hz: random.choose(&[50.0, 80.0, 100.0]).unwrap_or(80.0),
            range: arm.axes.iter().map(|axis| axis.range).collect(),
            chain,
            armature,
        }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Controller<'d> {
    design: &'d Design,
    before: Option<Vec<f64>>,
    rate: Vec<f64>,
    wanted: Vec<f64>,
    at: At,
}

impl<'d> Controller<'d> {
    pub(crate) fn new(design: &'d Design) -> Self {
        let count = design.stiffness.len();
        Self {
            design,
            before: None,
            rate: vec![0.0; count],
            wanted: vec![0.0; count],
            at: At::default(),
        }
    }

    /// The torques of one tick, from angles as they were read; `factors` are those of stiffness and damping.
    pub(crate) fn tick(
        &mut self,
        asked: &Asked,
        read: &[f64],
        factors: [f64; 2],
        torque: &mut [f64],
    ) {
        let design = self.design;
        let step = std::f64::consts::TAU * design.lowpass_hz / TICKS_PER_S;
        let share = step / (1.0 + step);
        match &mut self.before {
            None => self.before = Some(read.to_vec()),
            Some(before) => {
                for (joint, rate) in self.rate.iter_mut().enumerate() {
                    let raw = (read[joint] - before[joint]) * TICKS_PER_S;
                    *rate += share * (raw - *rate);
                    before[joint] = read[joint];
                }
            }
        }
        let count = torque.len();
        for joint in 0..count {
            self.wanted[joint] =
                factors[0] * design.stiffness[joint] * (asked.angle[joint] - read[joint])
                    + factors[1] * design.damping[joint] * (asked.rate[joint] - self.rate[joint]);
        }
        match design.kind {
            Kind::Gravity => {
                let still = [0.0; 16];
                design.chain.at(read, &still[..count], &mut self.at);
                for joint in 0..count {
                    torque[joint] = self.wanted[joint] + self.at.bias[joint];
                }
            }
            Kind::Computed => {
                design.chain.at(read, &self.rate, &mut self.at);
                for (wanted, asked) in self.wanted.iter_mut().zip(&asked.acceleration) {
                    *wanted += asked;
                }
                for joint in 0..count {
                    torque[joint] = self.at.needed(joint, &self.wanted, design.armature[joint]);
                }
            }
        }
        for (joint, own) in torque.iter_mut().enumerate() {
            *own = own.clamp(-design.range[joint], design.range[joint]);
        }
    }
}
