//! Logs that were written otherwise: a list of hypotheses, and the rule by which one of them refuses a log before a fit.

pub(crate) mod hypotheses;
mod misses;
mod outputs;
mod searched;
mod tracker;

use haptical_model::kinematics::nalgebra::{Quaternion, Rotation3, UnitQuaternion};
use haptical_model::{Device, Recording, Tracker};

use crate::CalibrationError;
use crate::problem::some_rows::spread_rows;
use crate::start::prepare::handle_poses;
use hypotheses::{Hypothesis, has_neighbours, of_joints, of_rows};
use misses::{LEAST_ROWS, Misses};

/// Rows that the hypotheses are tried on.
const MOST_ROWS: usize = 300;
/// What a device misses as logged, over the spread of what was measured and in rad, from which on a hypothesis is looked for.
const GROSS: f64 = 0.05;
/// How many times less must be missed with a hypothesis. A device file is off by the same for each of them.
const BETTER: f64 = 5.0;
/// The same where the hypothesis brings numbers that the closed form chooses: these fit a part of any error.
const BETTER_BY_NUMBERS: f64 = 10.0;
/// Ratio of what they miss up to which two hypotheses are as good.
const AS_GOOD: f64 = 1.5;

/// How far two devices are from each other along a recording: root mean square of their handle's positions over its spread, and of its
/// turns in rad, together, one of them seen by a tracker of the other that stands, and whose marker sits, where they agree best. Two
/// descriptions of one chain are nothing apart. None where a device has no links, or no pose at a row.
///
/// ```
/// use haptical_calibration::apart;
/// use haptical_model::{Device, Recording};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let rows = 0..40;
/// let joint = |joint: usize| rows.clone().map(|row| (0.1 * (row * (joint + 1)) as f64).sin()).collect();
/// let log = Recording {
///     line: rows.clone().map(|row| row as u64 + 2).collect(),
///     joint: (0..7).map(joint).collect(),
///     ..Recording::default()
/// };
/// let mut longer = device.clone();
/// longer.links[3].a_m += 0.1;
/// assert!(apart(&device, &device, &log).ok_or("no pose")? < 1e-6);
/// assert!(apart(&device, &longer, &log).ok_or("no pose")? > 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn apart(device: &Device, other: &Device, recording: &Recording) -> Option<f64> {
    let rows = spread_rows(recording.len(), MOST_ROWS);
    let some = recording.select(&rows);
    let poses = handle_poses(other, &some)
        .ok()
        .filter(|_| other.has_links())?;
    let axis = |axis: usize| poses.iter().map(|pose| pose.position_m[axis]).collect();
    let turns = poses.iter().map(|pose| {
        let turn = Rotation3::from_matrix_unchecked(pose.rotation);
        UnitQuaternion::from_rotation_matrix(&turn).into_inner()
    });
    let turns: Vec<Quaternion<f64>> = turns.collect();
    let part = |part: fn(&Quaternion<f64>) -> f64| turns.iter().map(part).collect();
    let seen = Recording {
        cable_m: Vec::new(),
        output: vec![None; some.joint.len()],
        position_m: Some([0, 1, 2].map(axis)),
        orientation_wxyz: Some([
            part(|turn| turn.w),
            part(|turn| turn.i),
            part(|turn| turn.j),
            part(|turn| turn.k),
        ]),
        ..some
    };
    let mut anywhere = device.clone();
    anywhere.tracker = Some(Tracker::default());
    anywhere.surroundings.tracker_base = None;
    anywhere.surroundings.tracker_tool = None;
    let misses = Misses::new(&anywhere, &seen);
    (misses.has_poses && misses.any()).then(|| misses.total(|_| true))
}

/// Refuses a log that misses the device by far, and several times less if its columns or rows, or the tracker's places, are
/// others.
///
/// # Errors
/// [`CalibrationError::MistakenLog`].
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let mut all = outputs::of_outputs(device, recording);
    if device.has_links() {
        all.extend(tracker::of_tracker(device, recording));
        all.extend(of_joints(device));
        all.extend(of_rows(recording));
    }
    let Some(missing) = Missing::new(device, recording) else {
        return Ok(());
    };
    missing.judge(&all)?;
    match device.has_links() {
        true => missing.judge(&searched::of_joints(device, recording, &missing.rows)),
        false => Ok(()),
    }
}

/// Refuses positions of runs between which the tracker was set up anew, where the device has one place for all: no fit of a device
/// makes sense of them. A diagnosis does, so it does not ask.
///
/// # Errors
/// [`CalibrationError::MistakenLog`] that says how to state a place for each run.
///
/// ```
/// use haptical_calibration::check_stands;
/// use haptical_model::{Device, Recording};
/// let device = Device::from_toml("[[joint]]", "one.toml")?.device;
/// assert!(check_stands(&device, &Recording::default()).is_ok());
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
pub fn check_stands(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let all = tracker::of_runs(device, recording);
    match Missing::new(device, recording).filter(|_| !all.is_empty()) {
        Some(missing) => missing.judge(&all),
        None => Ok(()),
    }
}

/// A hypothesis with what is missed as logged and with it, both of the channels that it changes, and then of all.
struct Found<'h> {
    hypothesis: &'h Hypothesis<'h>,
    channels: Vec<usize>,
    before: f64,
    after: f64,
    all: f64,
}

/// A log that misses its device by far.
struct Missing<'a> {
    device: &'a Device,
    recording: &'a Recording,
    rows: Vec<usize>,
    logged: Misses,
}

impl<'a> Missing<'a> {
    /// None where the log has few rows, or misses the device by less than what a device file is off by.
    fn new(device: &'a Device, recording: &'a Recording) -> Option<Self> {
        let inner = (0..recording.len()).filter(|&row| has_neighbours(recording, row));
        let mut rows: Vec<usize> = inner.collect();
        if rows.len() < LEAST_ROWS {
            rows = (0..recording.len()).collect();
        }
        if rows.len() < LEAST_ROWS {
            return None;
        }
        let some = spread_rows(rows.len(), MOST_ROWS).into_iter();
        let rows: Vec<usize> = some.map(|place| rows[place]).collect();
        let logged = Misses::new(device, &recording.select(&rows));
        (logged.total(|_| true) > GROSS).then_some(Self {
            device,
            recording,
            rows,
            logged,
        })
    }

    /// One rule for all hypotheses: what the channels miss that it changes is gross as logged and several times less with it.
    ///
    /// Of several the one with which all channels together miss least is named, with those that change the same channels, are as
    /// good and bring the fewest numbers.
    fn judge(&self, all: &[Hypothesis<'_>]) -> Result<(), CalibrationError> {
        let logged = &self.logged;
        let tried = all.iter().filter_map(|hypothesis| {
            let (device, log) = hypothesis.apply(self.device, self.recording, &self.rows);
            let with = Misses::new(&device, &log);
            let channels = logged.differ(&with);
            let [before, after] =
                [logged, &with].map(|misses| misses.total(|channel| channels.contains(&channel)));
            let better = match hypothesis.numbers {
                0 => BETTER,
                _ => BETTER_BY_NUMBERS,
            };
            let is_better = before > GROSS && after * better < before;
            // a change that leaves a row without a pose leaves nothing to compare
            (is_better && (with.has_poses || !logged.has_poses)).then(|| Found {
                hypothesis,
                channels,
                before,
                after,
                all: with.total(|_| true),
            })
        });
        let found: Vec<Found<'_>> = tried.collect();
        let Some(best) = found.iter().min_by(|a, b| a.all.total_cmp(&b.all)) else {
            return Ok(());
        };
        let as_good =
            |other: &&Found<'_>| other.channels == best.channels && other.all <= AS_GOOD * best.all;
        let as_good: Vec<&Found<'_>> = found.iter().filter(as_good).collect();
        let fewest = as_good.iter().map(|found| found.hypothesis.numbers).min();
        let is_named = |found: &&&Found<'_>| Some(found.hypothesis.numbers) == fewest;
        let named: Vec<&Found<'_>> = as_good.iter().filter(is_named).copied().collect();
        let what: Vec<&str> = named
            .iter()
            .map(|found| found.hypothesis.what.as_str())
            .collect();
        let first = named.first().copied().unwrap_or(best);
        Err(CalibrationError::MistakenLog {
            what: what.join(", or "),
            before: first.before,
            after: first.after,
            mend: first.hypothesis.mend,
        })
    }
}
