//! One joint's columns, episode by episode.

use std::ops::Range;

use super::scale::{median, spread};
use super::{EpisodeFinding, EpisodeLog, Fault, JointColumns};
use crate::thresholds::{EPISODE_STEP_S, FEWEST_EPISODE_ROWS, OTHER_RATE, REST_SHARE};

/// Position and command of a joint in the episodes that show it.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub(super) position: Vec<f64>,
    pub(super) command: Vec<f64>,
    /// Number of the episode and its rows.
    pub(super) episodes: Vec<(usize, Range<usize>)>,
    /// Median time between rows \[s\].
    pub(super) step_s: f64,
    /// Episodes whose rows are another time apart.
    pub(super) other_rates: usize,
}

impl Joint {
    /// None without commands.
    pub(super) fn new(log: &EpisodeLog<'_>, columns: &JointColumns<'_>) -> Option<Self> {
        let command = columns.command?;
        let episodes = log.episodes.iter().cloned().enumerate();
        let is_long = |rows: &Range<usize>| rows.len() >= FEWEST_EPISODE_ROWS;
        let is_read = |rows: &Range<usize>| {
            let mut left = rows.clone();
            left.any(|row| columns.position[row].is_finite() && command[row].is_finite())
        };
        Some(Self {
            position: columns.position.to_vec(),
            command: command.to_vec(),
            episodes: episodes
                .filter(|(_, rows)| is_long(rows) && is_read(rows))
                .collect(),
            step_s: step_s(log),
            other_rates: other_rates(log),
        })
    }

    /// A fast recording at a rate at which half a second is few rows: every so many rows of each episode.
    pub(super) fn thinned(self) -> Self {
        let stride = (EPISODE_STEP_S / self.step_s).floor().max(1.0) as usize;
        if stride == 1 || !self.step_s.is_finite() {
            return self;
        }
        let mut thin = Self {
            position: Vec::new(),
            command: Vec::new(),
            episodes: Vec::new(),
            step_s: self.step_s * stride as f64,
            ..self
        };
        for (episode, rows) in self.episodes {
            let start = thin.position.len();
            thin.position
                .extend(self.position[rows.clone()].iter().step_by(stride));
            thin.command
                .extend(self.command[rows].iter().step_by(stride));
            thin.episodes.push((episode, start..thin.position.len()));
        }
        thin
    }

    /// Without the episodes in which the joint rests: command and position move by next to nothing of what they do in others.
    pub(super) fn moving(&self) -> Self {
        let is_moving = |column: &[f64]| {
            let spreads =
                self.of_each(|joint, rows| spread(joint.rows(rows).map(|row| column[row])));
            let mut sorted = spreads.clone();
            sorted.sort_by(f64::total_cmp);
            let large = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or(0.0);
            spreads
                .into_iter()
                .map(move |spread| spread >= REST_SHARE * large && spread > 0.0)
                .collect::<Vec<_>>()
        };
        let (commands, positions) = (is_moving(&self.command), is_moving(&self.position));
        let mut moves = commands
            .iter()
            .zip(&positions)
            .map(|(command, position)| *command || *position);
        let mut moving = self.clone();
        moving.episodes.retain(|_| moves.next().unwrap_or(false));
        moving
    }

    /// Rows of an episode that have both.
    pub(super) fn rows(&self, rows: &Range<usize>) -> impl Iterator<Item = usize> + Clone + '_ {
        let is_read =
            |row: &usize| self.position[*row].is_finite() && self.command[*row].is_finite();
        rows.clone().filter(is_read)
    }

    /// Median of position less command in each episode.
    pub(super) fn levels(&self) -> Vec<f64> {
        self.of_each(|joint, rows| {
            let errors = joint
                .rows(rows)
                .map(|row| joint.position[row] - joint.command[row]);
            median(&mut errors.collect::<Vec<_>>())
        })
    }

    /// Standard deviation of the position over that of the command in each episode.
    pub(super) fn gains(&self) -> Vec<f64> {
        self.of_each(|joint, rows| {
            let of = |column: &[f64]| spread(joint.rows(rows).map(|row| column[row]));
            of(&joint.position) / of(&joint.command)
        })
    }

    fn of_each(&self, of: impl Fn(&Self, &Range<usize>) -> f64) -> Vec<f64> {
        self.episodes
            .iter()
            .map(|(_, rows)| of(self, rows))
            .collect()
    }

    /// Numbers of the episodes that show the joint, among all episodes.
    pub(super) fn by_episode(&self, log: &EpisodeLog<'_>, numbers: &[f64]) -> Vec<f64> {
        let mut all = vec![f64::NAN; log.episodes.len()];
        for ((episode, _), number) in self.episodes.iter().zip(numbers) {
            all[*episode] = *number;
        }
        all
    }

    /// Part of the readings that are equal to the one before, among rows whose command moves.
    pub(super) fn repeated(&self) -> f64 {
        let (mut moving, mut equal) = (0, 0);
        for (_, rows) in &self.episodes {
            for row in rows.clone().skip(1) {
                if self.command[row] != self.command[row - 1] {
                    moving += 1;
                    equal += usize::from(self.position[row] == self.position[row - 1]);
                }
            }
        }
        equal as f64 / f64::from(moving.max(1) as u32)
    }

    /// Least step of the position: what its sensor counts.
    pub(super) fn count(&self) -> f64 {
        let mut steps: Vec<f64> = Vec::new();
        for (_, rows) in &self.episodes {
            let pairs = self.position[rows.clone()].windows(2);
            steps.extend(
                pairs
                    .map(|pair| (pair[1] - pair[0]).abs())
                    .filter(|step| *step > 0.0),
            );
        }
        // a tenth of the steps are the least ones of a counter; rounding leaves smaller ones of no meaning
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 20).copied().unwrap_or(0.0)
    }

    /// Without the episodes of some findings.
    pub(super) fn without(&self, findings: &[EpisodeFinding]) -> Self {
        let has = |episode: usize| {
            let in_it = |found: &EpisodeFinding| {
                (found.since..=found.until.unwrap_or(usize::MAX)).contains(&episode)
            };
            findings.iter().any(in_it)
        };
        let mut left = self.clone();
        left.episodes.retain(|(episode, _)| !has(*episode));
        left
    }

    /// Leaves out the rows of positions at their limit.
    pub(super) fn leave_out_rows(&mut self, clipped: &[EpisodeFinding]) {
        for found in clipped {
            let Fault::Clipped { at, .. } = found.fault else {
                continue;
            };
            let last = found.until.unwrap_or(usize::MAX);
            for (_, rows) in self
                .episodes
                .iter()
                .filter(|(episode, _)| (found.since..=last).contains(episode))
            {
                for value in &mut self.position[rows.clone()] {
                    if *value == at {
                        *value = f64::NAN;
                    }
                }
            }
        }
    }

    /// With the numbers of the episodes in place of their places among those that show the joint.
    pub(super) fn named(&self, mut found: EpisodeFinding) -> EpisodeFinding {
        // what is there from the first episode that shows the joint on may be there before
        found.since = if found.since == 0 {
            0
        } else {
            self.episodes[found.since].0
        };
        found.until = found.until.map(|last| self.episodes[last].0);
        found
    }

    /// Makes a joint of one gain of one whose gain changed.
    pub(super) fn undo_gain(&mut self, found: &EpisodeFinding) {
        let Fault::Gain { factor, .. } = found.fault else {
            return;
        };
        let changed = self.places(found);
        self.change(&changed, |value| *value /= factor);
        // about which point it was is the level's
        let levels = self.levels();
        let middle = |part: &[f64]| median(&mut part.to_vec());
        let others = [&levels[..changed.start], &levels[changed.end..]].concat();
        let shift = middle(&levels[changed.clone()]) - middle(&others);
        self.change(&changed, |value| *value -= shift);
    }

    /// Places of a finding's episodes among those that show the joint.
    fn places(&self, found: &EpisodeFinding) -> Range<usize> {
        let before = |number: usize| {
            self.episodes
                .partition_point(|(episode, _)| *episode < number)
        };
        before(found.since)
            ..found
                .until
                .map_or(self.episodes.len(), |last| before(last + 1))
    }

    fn change(&mut self, places: &Range<usize>, of: impl Fn(&mut f64)) {
        for (_, rows) in &self.episodes[places.clone()] {
            self.position[rows.clone()].iter_mut().for_each(&of);
        }
    }

    /// Takes offsets out of the positions.
    pub(super) fn undo_offsets(&mut self, offsets: &[EpisodeFinding]) {
        for found in offsets {
            let Fault::Offset { size, .. } = found.fault else {
                continue;
            };
            let changed = self.places(found);
            self.change(&changed, |value| *value -= size);
        }
    }
}

/// Ranges of position and command in each episode.
pub(super) fn ranges(columns: &JointColumns<'_>, episodes: &[Range<usize>]) -> Vec<[f64; 2]> {
    let range = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let most = finite().fold(f64::NEG_INFINITY, f64::max);
        let least = finite().fold(f64::INFINITY, f64::min);
        (most - least).max(0.0)
    };
    let of = |rows: &Range<usize>| {
        let command = columns
            .command
            .map_or(0.0, |column| range(&column[rows.clone()]));
        [range(&columns.position[rows.clone()]), command]
    };
    episodes.iter().map(of).collect()
}

/// Median time between the rows of an episode \[s\]; `NaN` of one row.
pub(super) fn episode_step_s(log: &EpisodeLog<'_>, episode: usize) -> f64 {
    let times = &log.time_s[log.episodes[episode].clone()];
    let mut steps: Vec<f64> = times
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    if steps.is_empty() {
        f64::NAN
    } else {
        median(&mut steps)
    }
}

/// Episodes whose rows are another time apart than the others'.
fn other_rates(log: &EpisodeLog<'_>) -> usize {
    let usual = step_s(log);
    let is_other =
        |episode: &usize| (episode_step_s(log, *episode) / usual - 1.0).abs() > OTHER_RATE;
    (0..log.episodes.len()).filter(is_other).count()
}

/// Median time between rows \[s\].
pub(super) fn step_s(log: &EpisodeLog<'_>) -> f64 {
    let mut steps: Vec<f64> = Vec::new();
    for rows in log.episodes {
        steps.extend(
            log.time_s[rows.clone()]
                .windows(2)
                .map(|pair| pair[1] - pair[0]),
        );
    }
    steps.retain(|step| *step > 0.0);
    median(&mut steps)
}

/// Episodes of too few rows.
pub(super) fn short(log: &EpisodeLog<'_>) -> Vec<usize> {
    let all = 0..log.episodes.len();
    all.filter(|episode| log.episodes[*episode].len() < FEWEST_EPISODE_ROWS)
        .collect()
}
