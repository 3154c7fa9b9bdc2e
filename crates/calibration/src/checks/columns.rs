//! Mistaken columns that show before any fit: a joint turned, two in each other's place, all in reverse, rows that belong to
//! another posture.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, JointType, Recording};

use crate::CalibrationError;
use crate::checks::conventions::{angle_rad, error_m, seen_spread_m};
use crate::start::hand_eye::{Rig, closed_form, sights};
use crate::start::prepare::handle_poses;

/// Rows that the changed logs are tried on.
const MOST_ROWS: usize = 100;
/// Fewest rows: through fewer, wrong places fit as well.
const LEAST_ROWS: usize = 8;
/// Error of the device file, over the spread of what was measured and in rad, from which a change is looked for.
const GROSS: f64 = 0.05;
/// How many times smaller the error must be with a change. A device file is off by the same for each of them.
const BETTER: f64 = 5.0;
/// Ratio of their errors up to which two changes fit alike.
const AS_GOOD: f64 = 1.5;
/// Most joints of which every two are tried in each other's place; of more, neighbours alone.
const ALL_PAIRS: usize = 10;

/// Latest that a sensor is \[s\].
const LATENCY_S: f64 = 0.05;

/// A change that makes a log right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Change {
    /// A joint's column negated.
    Turned(usize),
    /// The columns of two joints in each other's place.
    Swapped(usize, usize),
    /// The columns of all joints in reverse order.
    Reversed,
    /// Joint angles with what was measured in the next row.
    Next,
    /// Joint angles with what was measured in the row before.
    Previous,
}

/// Every change of one joint's column, of two of one kind, and of all.
pub(crate) fn of_columns(device: &Device) -> Vec<Change> {
    let joints = &device.joints;
    let turned = (0..joints.len()).map(Change::Turned);
    let pairs = (0..joints.len()).flat_map(|a| (a + 1..joints.len()).map(move |b| (a, b)));
    let are_tried = |&(a, b): &(usize, usize)| {
        joints[a].joint_type == joints[b].joint_type && (joints.len() <= ALL_PAIRS || b == a + 1)
    };
    let swapped = pairs.filter(are_tried).map(|(a, b)| Change::Swapped(a, b));
    let are_alike = joints
        .windows(2)
        .all(|pair| pair[0].joint_type == pair[1].joint_type);
    let reversed = (joints.len() > 3 && are_alike).then_some(Change::Reversed);
    turned.chain(swapped).chain(reversed).collect()
}

/// The changes of rows, where a row is no latency of a sensor: they have no times, or are farther apart than those are late.
pub(crate) fn of_rows(recording: &Recording) -> Vec<Change> {
    let apart_s = recording.time_s.as_ref().map_or(f64::INFINITY, |times| {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
    });
    match apart_s > LATENCY_S {
        true => vec![Change::Next, Change::Previous],
        false => Vec::new(),
    }
}

/// Whether the rows before and after are the log's: none where rows in between were held out.
pub(crate) fn has_neighbours(recording: &Recording, row: usize) -> bool {
    let follows = |first: usize| {
        let lines = (recording.line.get(first), recording.line.get(first + 1));
        !matches!(lines, (Some(line), Some(next)) if *next > line + 1)
    };
    row > 0 && row + 1 < recording.len() && follows(row - 1) && follows(row)
}

impl Change {
    /// Rows of a recording as they are after the change; what has no neighbour keeps its own.
    pub(crate) fn of_rows(self, recording: &Recording, rows: &[usize]) -> Recording {
        let mut changed = recording.select(rows);
        match self {
            Self::Turned(joint) => {
                let column = changed.joint.get_mut(joint).into_iter().flatten();
                column.for_each(|reading| *reading = -*reading);
            }
            Self::Swapped(a, b) => changed.joint.swap(a, b),
            Self::Reversed => changed.joint.reverse(),
            Self::Next | Self::Previous => {
                let last = recording.len().saturating_sub(1);
                let neighbour = |&row: &usize| match self {
                    Self::Next => (row + 1).min(last),
                    _ => row.saturating_sub(1),
                };
                let neighbours: Vec<usize> = rows.iter().map(neighbour).collect();
                let other = recording.select(&neighbours);
                changed.cable_m = other.cable_m;
                changed.position_m = other.position_m;
                changed.orientation_wxyz = other.orientation_wxyz;
            }
        }
        changed
    }

    /// Whether it pairs rows anew.
    pub(crate) fn is_of_rows(self) -> bool {
        matches!(self, Self::Next | Self::Previous)
    }

    /// The change in words.
    pub(crate) fn words(self, device: &Device) -> String {
        let column = |joint: usize| match device.joints[joint].joint_type {
            JointType::Revolute => format!("`theta{}_rad`", joint + 1),
            JointType::Prismatic => format!("`theta{}_m`", joint + 1),
        };
        match self {
            Self::Turned(joint) => format!("column {} negated", column(joint)),
            Self::Swapped(a, b) => format!("columns {} and {} swapped", column(a), column(b)),
            Self::Reversed => "the columns of all joints in reverse order".to_owned(),
            Self::Next => "what is measured a row later".to_owned(),
            Self::Previous => "what is measured a row earlier".to_owned(),
        }
    }
}

/// Refuses a log that misses the device by far and that one change brings several times nearer.
///
/// # Errors
/// [`CalibrationError::MistakenLog`].
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let inner: Vec<usize> = (0..recording.len())
        .filter(|&row| has_neighbours(recording, row))
        .collect();
    let count = inner.len().min(MOST_ROWS);
    if count < LEAST_ROWS || !device.has_links() {
        return Ok(());
    }
    let some = (0..count).map(|index| inner[index * inner.len() / count]);
    let some: Vec<usize> = some.collect();
    let part = recording.select(&some);
    let Some(own) = error(device, &part).filter(|own| *own > GROSS) else {
        return Ok(());
    };
    let all = [of_columns(device), of_rows(recording)].concat();
    let tried = all.into_iter().filter_map(|change| {
        let error = error(device, &change.of_rows(recording, &some))?;
        (error * BETTER < own).then_some((error, change))
    });
    let mut found: Vec<(f64, Change)> = tried.collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(best, _)) = found.first() else {
        return Ok(());
    };
    let as_good = found.iter().filter(|(error, _)| *error <= AS_GOOD * best);
    let words: Vec<String> = as_good.map(|(_, change)| change.words(device)).collect();
    Err(CalibrationError::MistakenLog {
        what: words.join(", or "),
        before: own,
        after: best,
    })
}

/// What a device misses of a log: root of the sum of mean squares, positions and cables over their spread, turns in rad.
fn error(device: &Device, recording: &Recording) -> Option<f64> {
    let poses = handle_poses(device, recording).ok()?;
    let mut square = None;
    let mut add = |share: f64| {
        if share.is_finite() {
            square = Some(square.unwrap_or(0.0) + share * share);
        }
    };
    let rig = Rig::new(device).unwrap_or_default();
    let seen = sights(recording, &poses);
    if seen.len() >= LEAST_ROWS {
        let is_placed = seen.iter().any(|sight| sight.position_m.is_some());
        if is_placed {
            add(error_m(&seen, &rig) / seen_spread_m(&seen));
        }
        if seen.iter().any(|sight| sight.rotation.is_some()) {
            add(angle_rad(&seen, &closed_form(&seen, &rig)));
        }
    }
    for (cable, distances) in device.cables.iter().zip(&recording.cable_m) {
        if let Some(distances) = distances {
            add(cable_share(cable.anchor_m, distances, &poses));
        }
    }
    square.map(f64::sqrt)
}

/// Deviation of what a cable reads from the distance to its exit, over the deviation of the readings: its zero does not count.
fn cable_share(anchor_m: [f64; 3], distances_m: &[f64], poses: &[Pose]) -> f64 {
    let anchor_m = Vector3::from(anchor_m);
    let rows = poses
        .iter()
        .zip(distances_m)
        .filter(|(_, read)| read.is_finite());
    let (missed, read): (Vec<f64>, Vec<f64>) = rows
        .map(|(pose, read)| (read - (pose.position_m - anchor_m).norm(), *read))
        .unzip();
    if read.len() < LEAST_ROWS {
        return f64::NAN;
    }
    deviation(&missed) / deviation(&read)
}

fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = |value: &f64| (value - mean).powi(2);
    (values.iter().map(square).sum::<f64>() / count).sqrt()
}
