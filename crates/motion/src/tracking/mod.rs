//! Between command and torque: the law of the drives' controller, and how late it hears its commands.
//!
//! docs/equations.md, *Between command and torque*. Gains are free: what is found is a delay, and no gain.

mod answer;
mod fit;
mod law;
mod rows;

use haptical_model::{Device, Recording};

use self::answer::examined;
use self::fit::{Found, JointFit, fits, search};
use self::law::{Law, Signals};
use self::rows::{Reading, Rows};
use crate::arm::Arm;
use crate::effect::is_delay_of_all;
use crate::examined::Examined;
use crate::recorded::Logs;
use crate::thresholds::tracking::{
    IN_TIME_S, IN_TIME_STEPS, LEAST_NATS, LEAST_OF_JOINTS, LEFT_BY_DELAY, SURELY_LATE_SDS,
};

/// Name of the effect.
pub(crate) const NAME: &str = "command-latency";

/// Why a log does not say whether commands are heard late.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Untracked {
    /// It has no commands.
    NoCommands,
    /// Too few rows, or joints, in which the commands move.
    Short,
    /// Torques and positions have a gap of their own.
    Torques,
    /// No law explains the torques by the commands.
    NoLaw,
    /// A controller that weighs the command's speed less would do as well as this delay \[s\].
    Slow {
        /// The delay.
        delay_s: f64,
    },
    /// Positions that are logged late would do as well as this delay \[s\].
    Positions {
        /// The delay.
        delay_s: f64,
    },
}

impl std::fmt::Display for Untracked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoCommands => write!(
                f,
                "the log has no commands: log command1_rad, command2_rad, ... beside positions and torques"
            ),
            Self::Short => write!(
                f,
                "too few rows follow each other in which commands move: log some seconds of a motion without gaps"
            ),
            Self::Torques => write!(
                f,
                "torques and positions have a gap of their own: a delay of the commands is not looked for beside it"
            ),
            Self::NoLaw => write!(
                f,
                "no law of a controller that is known (stiffness and damping, with or without the model's torques; computed torque) gives the \
                 torques by the commands: log the torques that the controller asks for, without filters and changes of mode"
            ),
            Self::Slow { delay_s } => write!(
                f,
                "torques follow the commands as if these came {:.1} ms late, and as if the controller weighed their speed less: move faster, \
                 with commands above 1 Hz or steps, and diagnose again",
                1e3 * delay_s
            ),
            Self::Positions { delay_s } => write!(
                f,
                "torques follow the commands as if these came {:.1} ms late, and as if positions were logged late by less than a step: log at \
                 a higher rate",
                1e3 * delay_s
            ),
        }
    }
}

/// What commands and torques show.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracking {
    /// In the words of the torques; a channel is a joint's torque beside its controller's law. Before: without a delay.
    pub examined: Examined,
    /// The law, in words.
    pub law: &'static str,
    /// Joints (from 0) with commands whose torques the law does not give.
    pub others: Vec<usize>,
}

/// A law that explains the torques, and what it says of each joint.
struct Explained {
    rows: Rows,
    signals: Signals,
    law: Law,
    /// Joints by their index among those of the rows, each with the delay of its command, less that of the torques, and the standard
    /// deviation of that \[s\].
    joints: Vec<(usize, f64, f64)>,
    /// Whether that is one delay for all.
    is_shared: bool,
}

impl Explained {
    /// The delays that are none of a sound arm, by their place among the joints.
    fn late(&self) -> Vec<usize> {
        let limit_s = IN_TIME_S.max(IN_TIME_STEPS * self.rows.step_s);
        let is_late = |at: &usize| {
            let (_, delay_s, sd_s) = self.joints[*at];
            delay_s - SURELY_LATE_SDS * sd_s > limit_s
        };
        (0..self.joints.len()).filter(is_late).collect()
    }

    /// A joint's fit as it was found, or with its command as early as its torque.
    fn fit(&self, at: usize, is_as_found: bool) -> JointFit {
        let (index, delay_s, _) = self.joints[at];
        let own_s = self.rows.early_s + if is_as_found { delay_s } else { 0.0 };
        let equations = self.signals.equations(&self.rows, index, (self.law, own_s));
        fit::fit(&equations)
    }

    /// Whether a delay explains what joints have beyond noise without one.
    fn is_the_delay_s(&self, at: &[usize]) -> bool {
        let beyond = |is_as_found: bool| -> f64 {
            let fits = at.iter().map(|at| self.fit(*at, is_as_found));
            fits.map(|own| own.square - own.rest.len() as f64).sum()
        };
        beyond(true) <= LEFT_BY_DELAY * beyond(false).max(0.0)
    }

    /// What a delay explains of some joints beside the best law without one \[nats\].
    fn nats(&self, at: &[usize]) -> f64 {
        let indices: Vec<usize> = at.iter().map(|at| self.joints[*at].0).collect();
        let sum = |fits: &[JointFit]| -> f64 { fits.iter().map(|own| own.square).sum() };
        let mut others = Law::of_joints();
        if self.law.is_of_arm() {
            others = Law::of_arm();
        }
        others.push(self.law.weighted());
        let without = others.into_iter().map(|law| {
            let of = (law, self.rows.early_s);
            sum(&fits(&self.rows, &self.signals, of, &indices))
        });
        let least = without.fold(f64::INFINITY, f64::min);
        let own: f64 = at.iter().map(|at| self.fit(*at, true).square).sum();
        0.5 * (least - own)
    }
}

/// Whether the torques of a log follow its commands late, given what its torques show beside its positions; on a second recording as well,
/// if there is one. `without`: names of effects that are left out.
///
/// # Errors
/// [`Untracked`]: why the log does not say.
pub fn examine_tracking(
    device: &Device,
    (recording, second): (&Recording, Option<&Recording>),
    torques: &Examined,
    without: &[String],
) -> Result<Tracking, Untracked> {
    let mut arm = Arm::new(device).map_err(|_| Untracked::Short)?;
    // positions that the file says are late are so against the commands as well
    let stated_s = arm.early_s.iter().copied().fold(f64::INFINITY, f64::min);
    let stated_s = if stated_s.is_finite() {
        stated_s.max(0.0)
    } else {
        0.0
    };
    arm.early_s
        .iter_mut()
        .for_each(|early_s| *early_s -= stated_s);
    let logs = Logs::new(device, recording, second);
    let (recording, second) = (&logs.log, logs.second.as_ref());
    let latency = torques
        .findings
        .iter()
        .find(|own| is_delay_of_all(own.effect, own.joint));
    let named_s =
        stated_s + latency.map_or(0.0, |own| own.numbers.first().map_or(0.0, |own| own.1));
    let reading = |early_s: f64| Reading {
        early_s,
        edge_hz: torques.edge_hz,
    };
    let rows = Rows::of(&arm, recording, reading(named_s))?;
    // a rest that passes for noise with a memory follows the motion as well as the commands do
    if torques.has_memory() || torques.has_gap() && !torques.is_adequate() {
        return Err(Untracked::Torques);
    }
    let found = explained(rows)?;
    let late = found.late();
    let nats = if late.is_empty() {
        0.0
    } else {
        found.nats(&late)
    };
    if let Some(first) = late.first() {
        let delay_s = found.joints[*first].1;
        if nats < LEAST_NATS {
            return Err(Untracked::Slow { delay_s });
        }
        if !found.is_the_delay_s(&late) {
            return Err(Untracked::NoLaw);
        }
        // positions that are late by less than a sound arm's may be (A157)
        if latency.is_none() && torques.early_s > 0.0 {
            let again = explained(Rows::of(
                &arm,
                recording,
                reading(stated_s + torques.early_s),
            )?);
            if again.is_ok_and(|own| own.late().is_empty()) {
                return Err(Untracked::Positions { delay_s });
            }
        }
    }
    let is_named = !without.iter().any(|own| own == NAME);
    let second = second.map(|own| Rows::of(&arm, own, reading(named_s)));
    Ok(Tracking {
        law: found.law.words(),
        others: (0..found.rows.joints.len())
            .filter(|index| !found.joints.iter().any(|own| own.0 == *index))
            .map(|index| found.rows.joints[index])
            .collect(),
        examined: examined(&found, (&late, nats), is_named, second),
    })
}

/// The law that explains most, if it explains the torques of half of the joints.
fn explained(rows: Rows) -> Result<Explained, Untracked> {
    let signals = Signals::of(&rows)?;
    let all: Vec<usize> = (0..rows.joints.len()).collect();
    let least = (LEAST_OF_JOINTS * all.len() as f64).ceil() as usize;
    let explains = |found: &Found| found.fits.iter().filter(|own| own.is_noise()).count();
    let best = |laws: Vec<Law>| {
        let found = laws
            .into_iter()
            .map(|law| search(&rows, &signals, law, &all));
        found.min_by(|a, b| a.objective.total_cmp(&b.objective))
    };
    let mut found = best(Law::of_joints()).ok_or(Untracked::NoLaw)?;
    if explains(&found) < least {
        let of_arm = best(Law::of_arm()).filter(|own| explains(own) >= explains(&found));
        found = of_arm.unwrap_or(found);
    }
    let early_s = rows.early_s;
    let mut joints: Vec<(usize, f64, f64)> = all
        .iter()
        .filter(|index| found.fits[**index].is_noise())
        .map(|index| (*index, found.delay_s - early_s, found.sd_s))
        .collect();
    let mut is_shared = true;
    // the command of a joint by itself may be late
    let missed: Vec<usize> = all
        .iter()
        .copied()
        .filter(|index| !found.fits[*index].is_noise() && !found.law.is_of_arm())
        .collect();
    for index in missed {
        let own = search(&rows, &signals, found.law, &[index]);
        if own.fits[0].is_noise() {
            joints.push((index, own.delay_s - early_s, own.sd_s));
            is_shared = false;
        }
    }
    if joints.is_empty() || joints.len() < least {
        return Err(Untracked::NoLaw);
    }
    joints.sort_by_key(|own| own.0);
    Ok(Explained {
        law: found.law,
        rows,
        signals,
        joints,
        is_shared,
    })
}
