//! Faults of a recording of many episodes: which joint, what, how large, and since which episode.
//!
//! A joint is compared with itself: its answer to the command in one episode with that in the others. No device is needed. What a
//! joint does in all episodes alike (its lag, its droop) is its answer and no fault; docs/episodes.md has the derivations.

mod answer;
mod change_points;
mod clipped;
mod dead;
mod delay;
mod gain;
mod level;
mod moments;
mod rows;
mod scale;
mod series;
mod swapped;
mod verdict;

use std::ops::Range;

pub use self::rows::{RowFault, RowFaultKind};
pub use self::verdict::{EpisodeVerdict, Use};
use crate::effect;
use crate::thresholds::FEWEST_EPISODES;
use scale::median;
use series::Joint;

/// Columns of one joint in the order of the rows; a row without a reading is `NaN`.
#[derive(Debug, Clone, Copy)]
pub struct JointColumns<'a> {
    /// Measured positions, in any unit.
    pub position: &'a [f64],
    /// Commanded positions in the same unit.
    pub command: Option<&'a [f64]>,
}

/// A recording of several episodes, which follow one another in its rows.
#[derive(Debug, Clone)]
pub struct EpisodeLog<'a> {
    /// Times \[s\], increasing within an episode.
    pub time_s: &'a [f64],
    /// Rows of each episode.
    pub episodes: &'a [Range<usize>],
    /// The joints.
    pub joints: &'a [JointColumns<'a>],
    /// Rows that the recording's own description says each episode has; empty where it says nothing.
    pub described_rows: &'a [usize],
    /// Offsets below this, in the joints' unit, are no fault.
    pub least_offset: f64,
}

/// What is wrong with a joint. Numbers are in the joint's unit where no unit is said.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// Position less command has another constant.
    Offset {
        /// Position after less before.
        size: f64,
        /// Its standard deviation.
        sd: f64,
        /// Which of both columns moved to other values at the same episode.
        side: Option<Side>,
    },
    /// Changes of the position are as many times those before.
    Gain {
        /// Factor.
        factor: f64,
        /// Its standard deviation.
        sd: f64,
    },
    /// The position follows later.
    Latency {
        /// By so much \[s\]; negative where it follows earlier.
        delay_s: f64,
        /// Its standard deviation \[s\].
        sd_s: f64,
    },
    /// The position stays at one value while the command moves.
    Dead {
        /// Value.
        at: f64,
    },
    /// The position follows the command of another joint, and that one's position follows this one's command.
    Swapped {
        /// Index of the other joint.
        with: usize,
    },
    /// The position ends at one value while the command goes beyond.
    Clipped {
        /// Value.
        at: f64,
        /// Whether it is the largest.
        is_upper: bool,
        /// Share of the rows that read it.
        share: f64,
    },
}

impl Fault {
    /// Name of the effect.
    pub fn effect(&self) -> &'static str {
        match self {
            Self::Offset { .. } => effect::offset::NAME,
            Self::Gain { .. } => effect::gain::NAME,
            Self::Latency { .. } => effect::latency::NAME,
            Self::Dead { .. } => effect::recording::DEAD,
            Self::Swapped { .. } => effect::recording::SWAPPED,
            Self::Clipped { .. } => effect::recording::CLIPPED,
        }
    }
}

/// The measured or the commanding side; of two arms the follower and the leader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The measured positions.
    Position,
    /// The commands.
    Command,
}

/// A fault of a joint and the episodes that have it, by their index.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeFinding {
    /// What is wrong.
    pub fault: Fault,
    /// First episode.
    pub since: usize,
    /// Last episode; none where it is the last of the recording.
    pub until: Option<usize>,
    /// Probability that it is there: of its likelihood against none, one joint in a hundred having one beforehand; 0.99 at most.
    pub probability: f64,
}

/// How a joint answers its command in all episodes, and what is wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEpisodes {
    /// Faults, in the order of their episodes.
    pub findings: Vec<EpisodeFinding>,
    /// Median of position less command in each episode, `NaN` of one that is too short; empty without commands.
    pub levels: Vec<f64>,
    /// Position over command of each episode's motion (ratio of the standard deviations), in the same way.
    pub gains: Vec<f64>,
    /// Ranges of position and command in each episode.
    pub ranges: Vec<[f64; 2]>,
    /// How long after its command the joint is where it says, on average \[s\].
    pub answer_s: Option<f64>,
    /// Part of the readings that are equal to the one before while the command moves.
    pub repeated: f64,
    /// Whether the position follows the command; also true where one of them does not move enough to tell.
    pub follows: bool,
    /// Why a fault could not be looked for: words.
    pub not_tested: Vec<String>,
}

/// All that is found in a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeReport {
    /// Of each joint.
    pub joints: Vec<JointEpisodes>,
    /// Lost and repeated rows.
    pub rows: Vec<RowFault>,
    /// Of each episode.
    pub episodes: Vec<EpisodeVerdict>,
    /// Episodes that have too few rows to be looked at.
    pub short: Vec<usize>,
}

impl EpisodeReport {
    /// Whether nothing was found.
    pub fn is_sound(&self) -> bool {
        self.rows.is_empty() && self.joints.iter().all(|joint| joint.findings.is_empty())
    }
}

/// Looks for faults in a recording.
///
/// ```
/// use haptical_servo::{EpisodeLog, Fault, JointColumns, examine_episodes};
/// // twelve episodes of 3 s at 30 rows a second; from the eighth on the encoder reads 0.3 rad more
/// let rows = 12 * 90;
/// let time_s: Vec<f64> = (0..rows).map(|row| (row % 90) as f64 / 30.0).collect();
/// let command: Vec<f64> = (0..rows).map(|row| (0.07 * row as f64).sin() + 0.2 * (0.31 * row as f64).sin()).collect();
/// let position: Vec<f64> = (0..rows)
///     .map(|row: usize| command[row.saturating_sub(3)] + if row >= 7 * 90 { 0.3 } else { 0.0 })
///     .collect();
/// let episodes: Vec<_> = (0..12).map(|episode| 90 * episode..90 * (episode + 1)).collect();
/// let joints = [JointColumns { position: &position, command: Some(&command) }];
/// let log = EpisodeLog { time_s: &time_s, episodes: &episodes, joints: &joints, described_rows: &[], least_offset: 0.026 };
/// let found = &examine_episodes(&log).joints[0].findings;
/// assert!(matches!(found[0].fault, Fault::Offset { size, .. } if (size - 0.3).abs() < 0.01));
/// assert_eq!((found.len(), found[0].since), (1, 7));
/// ```
pub fn examine_episodes(log: &EpisodeLog<'_>) -> EpisodeReport {
    let swaps = swapped::swaps(log);
    let rows = rows::faults(log);
    let joints: Vec<JointEpisodes> = (log.joints.iter().enumerate())
        .map(|(joint, columns)| of_joint(log, columns, &swaps[joint]))
        .collect();
    let episodes = verdict::of_episodes(log, &joints, &rows);
    EpisodeReport {
        joints,
        rows,
        episodes,
        short: series::short(log),
    }
}

/// Why nothing is compared with the command.
const NOT_FOLLOWED: &str = "offset, gain, delay and clipped: the position does not follow the command, which may be a velocity, a step, of another unit or turned round";

fn of_joint(
    log: &EpisodeLog<'_>,
    columns: &JointColumns<'_>,
    swaps: &[EpisodeFinding],
) -> JointEpisodes {
    let ranges = series::ranges(columns, log.episodes);
    let Some(joint) = Joint::new(log, columns) else {
        return JointEpisodes {
            findings: Vec::new(),
            levels: Vec::new(),
            gains: Vec::new(),
            ranges,
            answer_s: None,
            repeated: 0.0,
            follows: true,
            not_tested: vec![
                "no command: offset, gain, delay, dead, swapped and clipped".to_owned(),
            ],
        };
    };
    let levels = joint.levels();
    let mut findings = swaps.to_vec();
    let clipped = clipped::faults(&joint, log.least_offset);
    // an episode whose commands all lie beyond a position's end shows a joint at rest
    let ends = clipped.iter().filter_map(|found| match found.fault {
        Fault::Clipped { at, .. } => Some(at),
        _ => None,
    });
    let ends: Vec<f64> = ends.collect();
    let dead = dead::faults(&joint, &ranges, log.least_offset).into_iter();
    findings.extend(
        dead.filter(|found| !matches!(found.fault, Fault::Dead { at } if ends.contains(&at))),
    );
    let mut not_tested = Vec::new();
    // what such an episode shows of offset, gain and delay is the fault itself
    let mut left = joint.without(&findings);
    left.leave_out_rows(&clipped);
    findings.extend(clipped);
    let mut left = left.thinned();
    let moves = |column: usize| {
        median(&mut ranges.iter().map(|range| range[column]).collect::<Vec<_>>())
            >= log.least_offset
    };
    let follows =
        answer::of(&left).is_none_or(|answer| answer.follows()) || !(moves(0) && moves(1));
    if !follows {
        // what the command is, is not known: no fault may be named against it
        findings.retain(|found| matches!(found.fault, Fault::Dead { .. } | Fault::Swapped { .. }));
        not_tested.push(NOT_FOLLOWED.to_owned());
    } else if left.episodes.len() < FEWEST_EPISODES {
        not_tested.push(format!(
            "changes of offset, gain and delay: it needs {FEWEST_EPISODES} episodes that show the joint and has {}",
            left.episodes.len()
        ));
    } else {
        let moving = left.moving();
        if let Some(gain) = gain::fault(&moving, log.least_offset) {
            let gain = moving.named(gain);
            left.undo_gain(&gain);
            findings.push(gain);
        }
        let is_in_unit = answer::of(&left).is_none_or(|answer| answer.is_in_unit());
        if is_in_unit || !(moves(0) && moves(1)) {
            // where a joint rests, friction and gravity of that pose alone make its level
            let moving = left.moving();
            let shown = if moving.episodes.len() >= FEWEST_EPISODES {
                &moving
            } else {
                &left
            };
            let offsets = level::faults(shown, log.least_offset);
            let offsets: Vec<EpisodeFinding> = offsets
                .into_iter()
                .map(|found| shown.named(found))
                .collect();
            left.undo_offsets(&offsets);
            findings.extend(offsets);
        } else {
            not_tested.push(
                "offset: position and command have other units, or a gain of all episodes"
                    .to_owned(),
            );
        }
        let moving = left.moving();
        match delay::fault(&moving) {
            Ok(found) => findings.extend(found.map(|found| moving.named(found))),
            Err(why) => not_tested.push(why),
        }
    }
    findings.sort_by_key(|finding| finding.since);
    let answer = answer::of(&left).filter(|answer| answer.follows() && answer.is_in_unit());
    JointEpisodes {
        findings,
        levels: joint.by_episode(log, &levels),
        gains: joint.by_episode(log, &joint.gains()),
        ranges,
        answer_s: answer
            .as_ref()
            .map(|answer| answer.after_s)
            .filter(|after_s| *after_s >= 0.0),
        repeated: joint.repeated(),
        follows,
        not_tested,
    }
}
