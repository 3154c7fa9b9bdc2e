//! What a log may have been written as: joints and rows.

use std::borrow::Cow;
use std::f64::consts::PI;

use haptical_model::{Device, JointType, Recording};

/// Most joints of which every two are tried in each other's place; of more, neighbours alone.
const ALL_PAIRS: usize = 10;
/// Latest that a sensor is \[s\].
const LATENCY_S: f64 = 0.05;

const SIGN_OR_ORDER: &str =
    "correct the log, or the sign or order of the joints in the device file";
pub(super) const UNITS: &str =
    "correct the log, or the counts and the transmission ratio that it was made with";
const SUMS: &str = "write each joint's angle against the link before it";
const ROWS: &str = "correct the log: write what was measured at one posture into one row";

/// A change of a log, or of what the device file says of it, that would make it right.
pub(crate) struct Hypothesis<'a> {
    /// The change in words, with its columns.
    pub(crate) what: String,
    /// What to do about it.
    pub(crate) mend: &'static str,
    /// Numbers that the closed form chooses with it.
    pub(crate) numbers: usize,
    change: Change<'a>,
}

enum Change<'a> {
    /// Some columns have other readings.
    Columns(Box<dyn Fn(&mut Recording) + 'a>),
    /// What is measured belongs to a row that is so many later.
    Rows(isize),
    /// The device file says otherwise.
    Device(Box<dyn Fn(&mut Device) + 'a>),
}

impl<'a> Hypothesis<'a> {
    pub(crate) fn of_columns(
        what: String,
        mend: &'static str,
        change: impl Fn(&mut Recording) + 'a,
    ) -> Self {
        let change = Change::Columns(Box::new(change));
        Self {
            what,
            mend,
            numbers: 0,
            change,
        }
    }

    pub(crate) fn of_device(
        what: String,
        mend: &'static str,
        numbers: usize,
        change: impl Fn(&mut Device) + 'a,
    ) -> Self {
        let change = Change::Device(Box::new(change));
        Self {
            what,
            mend,
            numbers,
            change,
        }
    }

    /// The same, with as many numbers as were chosen to fit the log.
    pub(super) fn with_numbers(self, numbers: usize) -> Self {
        Self { numbers, ..self }
    }

    /// Whether columns have other readings.
    pub(crate) fn is_of_columns(&self) -> bool {
        matches!(self.change, Change::Columns(_))
    }

    /// The device, and rows of the recording, with the change; what has no neighbour stays.
    pub(crate) fn apply<'d>(
        &self,
        device: &'d Device,
        recording: &Recording,
        rows: &[usize],
    ) -> (Cow<'d, Device>, Recording) {
        let mut changed = recording.select(rows);
        match &self.change {
            Change::Columns(change) => change(&mut changed),
            Change::Device(change) => {
                let mut device = device.clone();
                change(&mut device);
                return (Cow::Owned(device), changed);
            }
            Change::Rows(later) => {
                let last = recording.len().saturating_sub(1);
                let neighbour = |row: &usize| row.saturating_add_signed(*later).min(last);
                let neighbours: Vec<usize> = rows.iter().map(neighbour).collect();
                let other = recording.select(&neighbours);
                changed.cable_m = other.cable_m;
                changed.position_m = other.position_m;
                changed.orientation_wxyz = other.orientation_wxyz;
                changed.tool = other.tool;
            }
        }
        (Cow::Borrowed(device), changed)
    }
}

/// A joint's column as the log has it, `name` before the joint's number.
pub(super) fn column(device: &Device, name: &str, joint: usize) -> String {
    let unit = device.joints.get(joint).map_or("rad", |joint| joint.unit());
    format!("`{name}{}_{unit}`", joint + 1)
}

/// Multiplies a column.
pub(super) fn scale(column: &mut [f64], factor: f64) {
    column.iter_mut().for_each(|reading| *reading *= factor);
}

/// Signs, factors, sums, order: of one joint's column, of two of one kind, and of all.
pub(crate) fn of_joints(device: &Device) -> Vec<Hypothesis<'static>> {
    let joints = &device.joints;
    let theta = |joint: usize| column(device, "theta", joint);
    let pairs = (0..joints.len()).flat_map(|a| (a + 1..joints.len()).map(move |b| (a, b)));
    let are_alike = |a: usize, b: usize| joints[a].joint_type == joints[b].joint_type;
    let mut all = Vec::new();
    let mut add = |what, mend, change: Box<dyn Fn(&mut Recording)>| {
        all.push(Hypothesis::of_columns(what, mend, change));
    };
    for (joint, described) in joints.iter().enumerate() {
        let times =
            |factor: f64| Box::new(move |log: &mut Recording| scale(&mut log.joint[joint], factor));
        let name = theta(joint);
        add(format!("column {name} negated"), SIGN_OR_ORDER, times(-1.0));
        add(format!("column {name} times 2"), UNITS, times(2.0));
        add(format!("column {name} divided by 2"), UNITS, times(0.5));
        match described.joint_type {
            JointType::Revolute => add(
                format!("column {name} times pi/180"),
                UNITS,
                times(PI / 180.0),
            ),
            JointType::Prismatic => {
                add(format!("column {name} divided by 1000"), UNITS, times(1e-3));
            }
        }
    }
    for (a, b) in pairs.filter(|&(a, b)| are_alike(a, b)) {
        if joints.len() <= ALL_PAIRS || b == a + 1 {
            let what = format!("columns {} and {} swapped", theta(a), theta(b));
            add(
                what,
                SIGN_OR_ORDER,
                Box::new(move |log| log.joint.swap(a, b)),
            );
        }
        if b > a + 1 || joints[a].joint_type != JointType::Revolute {
            continue;
        }
        // an angle against the horizontal, or against the ground, is the sum of two
        for (changed, added, sign, word) in [
            (b, a, 1.0, "plus"),
            (b, a, -1.0, "minus"),
            (a, b, 1.0, "plus"),
            (a, b, -1.0, "minus"),
        ] {
            let what = format!("column {} {word} {}", theta(changed), theta(added));
            let change = move |log: &mut Recording| {
                let added = log.joint[added].clone();
                let pairs = log.joint[changed].iter_mut().zip(added);
                pairs.for_each(|(reading, added)| *reading += sign * added);
            };
            add(what, SUMS, Box::new(change));
        }
    }
    if joints.len() > 3 && (1..joints.len()).all(|joint| are_alike(joint - 1, joint)) {
        let what = "the columns of all joints in reverse order".to_owned();
        add(what, SIGN_OR_ORDER, Box::new(|log| log.joint.reverse()));
    }
    all
}

/// Shifts of rows, where a row is no latency of a sensor: they have no times, or are farther apart than those are late.
pub(crate) fn of_rows(recording: &Recording) -> Vec<Hypothesis<'static>> {
    let apart_s = recording.time_s.as_ref().map_or(f64::INFINITY, |times| {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
    });
    let shifts = [
        (1, "what is measured a row later"),
        (-1, "what is measured a row earlier"),
    ];
    let shifts = shifts.into_iter().filter(|_| apart_s > LATENCY_S);
    let shift = |(later, what): (isize, &str)| Hypothesis {
        what: what.to_owned(),
        mend: ROWS,
        numbers: 0,
        change: Change::Rows(later),
    };
    shifts.map(shift).collect()
}

/// Whether the rows before and after are the log's: none where rows in between were held out.
pub(crate) fn has_neighbours(recording: &Recording, row: usize) -> bool {
    let follows = |first: usize| {
        let lines = (recording.line.get(first), recording.line.get(first + 1));
        !matches!(lines, (Some(line), Some(next)) if *next > line + 1)
    };
    row > 0 && row + 1 < recording.len() && follows(row - 1) && follows(row)
}
