//! Torques of something else: nothing that an arm's equations could explain.

use std::f64::consts::TAU;

use crate::moving::arms::Arm;
use crate::moving::motion::log::Ticks;
use crate::random::Random;

/// What stands in the place of the torques.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sloppy {
    /// Those of the other recording.
    OtherRun,
    /// Those of other joints, in shares of their ranges.
    OtherJoints,
    /// Tones that no arm has seen.
    Nothing,
}

impl Sloppy {
    pub(crate) fn of(number: u64) -> Self {
        [Self::OtherRun, Self::OtherJoints, Self::Nothing][(number % 3) as usize]
    }

    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::OtherRun => "torques-of-another-run",
            Self::OtherJoints => "torques-of-other-joints",
            Self::Nothing => "torques-of-nothing",
        }
    }

    /// Puts it into a recording; `other` is the arm's other recording, of as many ticks.
    pub(crate) fn replace(self, ticks: &mut Ticks, other: &Ticks, arm: &Arm, random: &mut Random) {
        match self {
            Self::OtherRun => ticks.torque.clone_from(&other.torque),
            Self::OtherJoints => {
                let count = arm.count();
                let of = |joint: usize| -> Vec<f64> {
                    let from = (joint + 2) % count;
                    let scale = arm.axes[joint].range / arm.axes[from].range;
                    let torque = ticks.torque[from].iter().map(|torque| torque * scale);
                    torque.collect()
                };
                ticks.torque = (0..count).map(of).collect();
            }
            Self::Nothing => {
                for (torque, axis) in ticks.torque.iter_mut().zip(arm.axes) {
                    let tones = [(); 6].map(|()| {
                        let size = axis.range * random.uniform(0.02, 0.12);
                        [random.around(0.5, 10.0), size, random.phase_rad()]
                    });
                    for (torque, time_s) in torque.iter_mut().zip(&ticks.time_s) {
                        let tone = |[hz, size, phase]: &[f64; 3]| {
                            size * libm::sin(TAU * hz * time_s + phase)
                        };
                        *torque = tones.iter().map(tone).sum();
                    }
                }
            }
        }
    }
}
