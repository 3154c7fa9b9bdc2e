//! Runs of a recording, and the steps between its rows: of a motion or between postures.

use std::ops::Range;

use haptical_model::{Device, JointType, Recording};

/// Rows of one run each: where the number of the run changes, or the time starts anew. A log without either is one run.
///
/// ```
/// use haptical_model::Recording;
/// let recording = Recording {
///     time_s: Some(vec![0.0, 0.1, 0.0, 0.1]),
///     joint: vec![vec![0.0; 4]],
///     ..Recording::default()
/// };
/// assert_eq!(haptical_effects::runs_of(&recording), [0..2, 2..4]);
/// ```
pub fn runs_of(recording: &Recording) -> Vec<Range<usize>> {
    let rows = recording.len();
    let mut runs = Vec::new();
    let mut start = 0;
    for row in 1..=rows {
        let ends = row == rows
            || recording
                .run
                .as_ref()
                .is_some_and(|run| run[row] != run[row - 1])
            || recording
                .time_s
                .as_ref()
                .is_some_and(|time_s| time_s[row] <= time_s[row - 1]);
        if ends {
            runs.push(start..row);
            start = row;
        }
    }
    runs
}

/// A step between rows of at most this share of a joint's range is one of a motion, not one between postures.
pub(super) const STEP_OF_A_MOTION: f64 = 0.05;
/// Fewer rows are taken as single postures.
const ROWS_OF_A_MOTION: usize = 64;

/// Share of the joints' ranges that a step of a motion takes at most, over half of its way. Steps vary about their median by
/// their speed: twice as much as above is a motion still.
const LONG_STEP: f64 = 0.1;
/// Steps over which a path without times must lead somewhere.
const LEADING_STEPS: usize = 8;
/// Share of the way of so many steps that a path gains; of postures in any order it is 1 / sqrt(8).
const GAINED: f64 = 0.5;

/// Samples on each side over which torques and forces are averaged at most, ...
const LOAD_REACH: usize = 4;
/// ... for how long \[s\]: a mean over 0.08 s takes 3 % off a hand's force of 1.5 Hz, ...
const LOAD_REACH_S: f64 = 0.04;
/// ... and how far the joints may move meanwhile, as a share of their range.
const LOAD_IS_STEADY: f64 = 0.04;

/// Samples on each side over which loads hardly change: neither by the posture nor, of a hand that pushes, in time.
pub(super) fn load_reach(step: f64, recording: &Recording, runs: &[Range<usize>]) -> usize {
    let by_posture = match step * LOAD_REACH as f64 <= LOAD_IS_STEADY {
        true => LOAD_REACH,
        false => (LOAD_IS_STEADY / step) as usize,
    };
    let Some(time_s) = &recording.time_s else {
        return by_posture;
    };
    let (mut seconds, mut steps) = (0.0, 0.0);
    for run in runs.iter().filter(|run| run.len() > 1) {
        seconds += time_s[run.end - 1] - time_s[run.start];
        steps += (run.len() - 1) as f64;
    }
    let row_s = seconds / f64::max(steps, 1.0);
    // a hair more, so that rows of 10 ms are not 9.999 of them
    match row_s > 0.0 {
        true => by_posture.min((LOAD_REACH_S / row_s * (1.0 + 1e-6)) as usize),
        false => by_posture,
    }
}

/// Whether rows follow a path: half of its way is made in short steps, and without times it leads somewhere. Of postures
/// that are recorded several times each the median step is zero, but their way is made in long steps.
pub(super) fn is_path(recording: &Recording, runs: &[Range<usize>]) -> bool {
    let mut ranges = 0.0;
    for column in &recording.joint {
        ranges += range(column).powi(2);
    }
    let way = |from: usize, to: usize| -> f64 {
        let joints = recording.joint.iter();
        let squares = joints.map(|column| (column[to] - column[from]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let rows = || runs.iter().flat_map(|run| run.start + 1..run.end);
    let mut steps: Vec<f64> = rows().map(|row| way(row - 1, row)).collect();
    let whole: f64 = steps.iter().sum();
    steps.sort_by(|a, b| b.total_cmp(a));
    let mut made = 0.0;
    let half = steps.iter().find(|step| {
        made += **step;
        made >= 0.5 * whole
    });
    let is_short = half.is_some_and(|step| *step <= LONG_STEP * ranges.sqrt());
    if recording.time_s.is_some() || !is_short {
        return is_short;
    }
    let (mut gained, mut walked) = (0.0, 0.0);
    for run in runs {
        for end in run.start + LEADING_STEPS..run.end {
            gained += way(end - LEADING_STEPS, end);
            walked += (end - LEADING_STEPS..end)
                .map(|row| way(row, row + 1))
                .sum::<f64>();
        }
    }
    walked > 0.0 && gained >= GAINED * walked
}

/// Travel below which a joint rests: its encoder's counts, and what its brake gives way. Choice.
const LEAST_TRAVEL_RAD: f64 = 1e-3;
const LEAST_TRAVEL_M: f64 = 1e-4;

/// Whether a joint moves in a recording, more than by its encoder's counts.
pub(crate) fn moves(device: &Device, recording: &Recording, joint: usize) -> bool {
    let least = match device.joints[joint].joint_type {
        JointType::Revolute => LEAST_TRAVEL_RAD,
        JointType::Prismatic => LEAST_TRAVEL_M,
    };
    range(&recording.joint[joint]) >= least
}

/// Highest less lowest reading.
fn range(column: &[f64]) -> f64 {
    let low = column.iter().copied().fold(f64::INFINITY, f64::min);
    let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low).max(0.0)
}

/// Motion between successive rows: the median step of the joint that moves most, over its range; none for
/// a few rows, or where nothing moves between rows.
pub(super) fn step_of_range(
    device: &Device,
    recording: &Recording,
    runs: &[Range<usize>],
) -> Option<f64> {
    if recording.len() < ROWS_OF_A_MOTION {
        return None;
    }
    let mut largest: f64 = 0.0;
    // a held joint whose encoder flickers takes steps as long as its range
    let moving = (0..recording.joint.len()).filter(|&joint| moves(device, recording, joint));
    for joint in moving {
        let column = &recording.joint[joint];
        let range = range(column);
        let steps: Vec<f64> = runs
            .iter()
            .flat_map(|run| {
                (run.start + 1..run.end).map(|row| (column[row] - column[row - 1]).abs())
            })
            .collect();
        largest = largest.max(haptical_metrics::median(&steps).ok()? / range);
    }
    Some(largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded(column: Vec<f64>, timed: bool) -> Recording {
        Recording {
            time_s: timed.then(|| (0..column.len()).map(|row| 0.01 * row as f64).collect()),
            line: (2..).take(column.len()).collect(),
            joint: vec![column],
            ..Recording::default()
        }
    }

    fn is_path_of(column: Vec<f64>, timed: bool) -> bool {
        let recording = recorded(column, timed);
        is_path(&recording, &runs_of(&recording))
    }

    #[test]
    fn repeated_postures_are_no_path_although_most_steps_are_zero() {
        let posture = |row: usize| (7.3 * (row / 3) as f64).sin();
        let repeated: Vec<f64> = (0..600).map(posture).collect();
        let recording = recorded(repeated.clone(), false);
        let text = "[[joint]]\nname = \"one\"\n";
        let device = Device::from_toml(text, "one.toml").unwrap().device;
        assert_eq!(
            step_of_range(&device, &recording, &runs_of(&recording)),
            Some(0.0)
        );
        assert!(!is_path_of(repeated.clone(), false) && !is_path_of(repeated, true));
    }

    #[test]
    fn a_motion_with_rests_is_a_path_with_and_without_times() {
        let moving = |row: usize| (0.02 * (row.clamp(100, 500)) as f64).sin();
        let rounded = |row: usize| (moving(row) * 1e3).round() * 1e-3;
        for timed in [true, false] {
            assert!(is_path_of((0..600).map(moving).collect(), timed));
            assert!(is_path_of((0..600).map(rounded).collect(), timed));
        }
    }

    #[test]
    fn small_steps_to_and_fro_are_a_path_with_times_alone() {
        // a walk that turns at random
        let mut at = 0.0;
        let walk: Vec<f64> = (0..600)
            .map(|row| {
                at += 0.02 * (97.7 * f64::from(row) * f64::from(row)).sin().signum();
                at
            })
            .collect();
        assert!(is_path_of(walk.clone(), true));
        assert!(!is_path_of(walk, false));
    }
}
