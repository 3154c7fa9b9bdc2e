//! How a recorded torque goes with what the links ask for: its sign, its scale, and whether it is theirs at all.

use std::rc::Rc;

use haptical_linalg::dot;

use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::thresholds::scale::{
    DRIVEN_SHARE, FOLLOWS_LINKS, KNOWN_SLOPE, NOISE_SCATTERS, OTHER_SIGN, SAME_UNIT, SILENT_SDS,
    SILENT_SHARE,
};

/// How a channel's recorded torque goes with that of the nominal bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The recorded torque over that of the nominal bodies; friction, an offset and an armature that is not stated fitted beside it.
    pub slope: f64,
    /// Its standard deviation, what the fit leaves allowed for.
    pub sd: f64,
    /// Share of the recorded torque's variance that the fit explains.
    pub explained: f64,
    /// Root mean square about the mean of what the bodies and the device's effects ask for, in standard deviations of the noise of a row.
    pub asked: f64,
    /// The same of the torque as it was read.
    pub heard: f64,
    /// Root mean square of the friction that is fitted, over that of the torque as it was read; below zero where it drives the motion.
    pub friction: f64,
    /// Rows.
    pub rows: usize,
}

/// What is wrong with torques, so that nothing of them may get a name.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// A joint's torque has the other sign than what its links ask for.
    Sign {
        /// Joint, from 0.
        joint: usize,
        /// Slope.
        slope: f64,
    },
    /// Most torques are multiples of what their links ask for.
    Unit {
        /// Joints, from 0, with their slopes.
        slopes: Vec<(usize, f64)>,
    },
    /// A joint's torque is noise, though its links ask for more.
    Silent {
        /// Joint, from 0.
        joint: usize,
    },
    /// The friction in a joint's torque drives its motion.
    Driven {
        /// Joint, from 0.
        joint: usize,
    },
}

impl Scale {
    /// Of a channel.
    pub(crate) fn of(problem: &Problem, base: &Base, channel: usize) -> Self {
        let (joint, rows) = (problem.channels[channel], problem.states.rows());
        let motor = &problem.states.motor;
        let mut signals = vec![
            problem.nominal_torque()[joint].clone(),
            motor.dq[joint].clone(),
            base.sign(problem, joint),
            vec![1.0; problem.states.steps()],
        ];
        if problem.arm.armature[joint].is_none() {
            signals.push(motor.ddq[joint].clone());
        }
        let columns = signals
            .iter()
            .filter_map(|own| problem.of_joint(joint, own));
        let columns: Vec<Rc<Column>> = columns.map(Rc::new).collect();
        let first = channel * rows;
        let torque = problem.states.torque(&problem.samples, joint, 0.0);
        let mut target = vec![0.0; problem.channel_rows()];
        for (row, torque) in torque.into_iter().enumerate() {
            target[first + row] = torque * problem.weight(first + row);
        }
        let solved = System::new(&columns, &vec![None; columns.len()]).solve(&target, &[]);
        let left = dot(&solved.rest, &solved.rest);
        let misfit = (left / rows as f64).max(1.0);
        let read = &target[first..][..rows];
        let mut asked = vec![0.0; target.len()];
        let friction = problem.file_effects.columns(problem).into_iter();
        let friction = friction.map(|friction| friction.column);
        let of_channel = friction.filter(|column| column.parts().0 == first);
        for column in columns.first().cloned().into_iter().chain(of_channel) {
            column.add_to(&mut asked, 1.0);
        }
        let spread = |square: f64| (square / rows as f64).sqrt();
        let heard = spread(about_mean(read));
        let mut friction = vec![0.0; target.len()];
        for (column, factor) in columns.iter().zip(&solved.solution).skip(1).take(2) {
            column.add_to(&mut friction, *factor);
        }
        let drag = columns.get(1).map_or(0.0, |speed| speed.dot(&friction));
        let friction = spread(dot(&friction, &friction)) / heard.max(f64::MIN_POSITIVE);
        Self {
            slope: solved.solution.first().copied().unwrap_or(0.0),
            sd: (solved.covariance(&[0])[(0, 0)] * misfit).sqrt(),
            explained: 1.0 - left / about_mean(read).max(1e-300),
            asked: spread(about_mean(&asked[first..][..rows])),
            heard,
            friction: friction.copysign(drag),
            rows,
        }
    }

    /// Whether the slope is known, of a torque that is a multiple of what its links ask for.
    pub fn is_known(&self) -> bool {
        self.sd > 0.0
            && 3.0 * self.sd < KNOWN_SLOPE * self.slope.abs().max(1.0)
            && self.explained > FOLLOWS_LINKS
            && !self.is_noise()
    }

    /// Whether the torque is no more than noise.
    pub fn is_noise(&self) -> bool {
        self.heard < NOISE_SCATTERS
    }

    /// Whether it is noise where its links ask for more: by its size, or as it has little of what they ask for.
    fn is_silent(&self) -> bool {
        let square = self.heard.powi(2);
        let sd = square * (2.0 / self.rows.max(1) as f64).sqrt();
        let is_small = square + SILENT_SDS * sd < 1.0 + SILENT_SHARE * self.asked.powi(2);
        let is_without =
            self.asked > 1.0 && self.slope + SILENT_SDS * self.sd < SILENT_SHARE.sqrt();
        self.is_noise() && (is_small || is_without)
    }

    /// Whether its friction drives the motion, as no friction does.
    fn is_driven(&self) -> bool {
        !self.is_noise() && self.explained > FOLLOWS_LINKS && self.friction < -DRIVEN_SHARE
    }
}

/// Sum of squares about the mean.
fn about_mean(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|own| (own - mean).powi(2)).sum()
}

/// What is wrong with torques, from how each goes with what its links ask for.
pub(crate) fn doubts(scales: &[(usize, Scale)]) -> Vec<Doubt> {
    let silent = scales.iter().filter(|(_, own)| own.is_silent());
    let mut found: Vec<Doubt> = silent
        .map(|(joint, _)| Doubt::Silent { joint: *joint })
        .collect();
    let driven = scales.iter().filter(|(_, own)| own.is_driven());
    found.extend(driven.map(|(joint, _)| Doubt::Driven { joint: *joint }));
    let known: Vec<(usize, f64)> = (scales.iter())
        .filter(|(_, own)| own.is_known())
        .map(|(joint, own)| (*joint, own.slope))
        .collect();
    let is_turned = |slope: f64| slope < OTHER_SIGN && slope > -SAME_UNIT.end;
    let turned = known.iter().filter(|(_, slope)| is_turned(*slope));
    found.extend(turned.map(|(joint, slope)| Doubt::Sign {
        joint: *joint,
        slope: *slope,
    }));
    let off: Vec<(usize, f64)> = (known.iter().copied())
        .filter(|(_, slope)| !SAME_UNIT.contains(&slope.abs()))
        .collect();
    let is_one_unit = off.len() > 1
        && 2 * off.len() > known.len()
        && (off.iter().all(|own| own.1.abs() < SAME_UNIT.start)
            || off.iter().all(|own| own.1.abs() > SAME_UNIT.start));
    if is_one_unit {
        found.push(Doubt::Unit { slopes: off });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(slope: f64) -> Scale {
        Scale {
            slope,
            sd: 0.01 * slope.abs(),
            explained: 0.95,
            asked: 20.0,
            heard: 20.0 * slope.abs().max(0.1),
            friction: 0.2,
            rows: 800,
        }
    }

    fn of(slopes: &[f64]) -> Vec<Doubt> {
        let scales = slopes.iter().map(|own| scale(*own)).enumerate();
        doubts(&scales.collect::<Vec<_>>())
    }

    #[test]
    fn sound_torques_and_one_gain_are_in_no_doubt() {
        assert_eq!(of(&[1.0, 0.9, 1.2, 1.05]), []);
        assert_eq!(of(&[1.0, 0.9, 4.0, 1.05]), []);
        assert_eq!(of(&[1.0, 0.9, 0.1, 1.05]), []);
        // a heavy payload
        assert_eq!(of(&[1.0, 3.0, 4.0, 6.0]), []);
        // the last joint of an arm whose hand is centred on it
        assert_eq!(of(&[1.0, 0.9, 1.1, -17.7]), []);
    }

    #[test]
    fn one_sign_and_one_unit_are_told_apart() {
        assert_eq!(
            of(&[1.0, -0.98, 1.1]),
            [Doubt::Sign {
                joint: 1,
                slope: -0.98
            }]
        );
        let slopes = vec![(0, 0.07), (1, 0.09), (2, 0.06)];
        assert_eq!(of(&[0.07, 0.09, 0.06]), [Doubt::Unit { slopes }]);
        let slopes = vec![(0, 1000.0), (1, 990.0)];
        assert_eq!(of(&[1000.0, 990.0]), [Doubt::Unit { slopes }]);
    }

    #[test]
    fn noise_is_no_torque_where_links_ask_for_one() {
        let silent = Scale {
            slope: 0.0,
            sd: 0.02,
            explained: 0.01,
            heard: 1.02,
            ..scale(1.0)
        };
        assert_eq!(
            doubts(&[(0, scale(1.0)), (2, silent)]),
            [Doubt::Silent { joint: 2 }]
        );
        // noise as large as what the links ask for
        let loud = Scale {
            asked: 1.7,
            heard: 1.34,
            ..silent
        };
        assert_eq!(doubts(&[(2, loud)]), [Doubt::Silent { joint: 2 }]);
        let drowned = Scale { sd: 0.3, ..loud };
        assert_eq!(doubts(&[(2, drowned)]), []);
        // a wrist that nothing loads
        let idle = Scale {
            asked: 0.5,
            ..silent
        };
        assert_eq!(doubts(&[(0, scale(1.0)), (2, idle)]), []);
    }

    #[test]
    fn friction_drives_no_joint() {
        let wrist = |friction: f64| Scale {
            friction,
            ..scale(-0.27)
        };
        assert_eq!(doubts(&[(5, wrist(-0.8))]), [Doubt::Driven { joint: 5 }]);
        // little of it, or a torque that nothing explains, says nothing
        for friction in [-0.1, 0.8] {
            assert_eq!(doubts(&[(0, scale(1.0)), (5, wrist(friction))]), []);
        }
        let foreign = Scale {
            explained: 0.5,
            ..wrist(-0.8)
        };
        assert_eq!(doubts(&[(0, scale(1.0)), (5, foreign)]), []);
    }
}
