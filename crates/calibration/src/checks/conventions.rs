//! Columns of a tracker in another convention than the log's: left-handed axes, quaternions in another order, poses the
//! other way round, another frame.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Recording, Tracker};

use crate::CalibrationError;
use crate::problem::measurement::rotation::rotation_vector;
use crate::start::hand_eye::{closed_form, missed};
use crate::start::points::spread_m;
use crate::start::prepare::handle_poses;
use crate::start::sights::{Frames, Rig, Sight, sights};

/// Rows that the conventions are tried on.
const MOST_ROWS: usize = 300;
/// Fewest rows: through fewer, wrong places and turns fit as well.
const LEAST_ROWS: usize = 8;
/// Root mean square error over the spread of what was seen, from which on no device file explains it: devices are
/// known to a hundredth.
const GROSS_SHARE: f64 = 0.05;
/// The same of orientations \[rad\].
const GROSS_RAD: f64 = 0.2;
/// How many times better another convention must fit to be named.
const BETTER: f64 = 10.0;
/// Ratio of their errors up to which two conventions fit alike.
const AS_GOOD: f64 = 2.0;

/// What a wrong position column may be, as the matrix that puts it right, in words.
type Mirror = (Matrix3<f64>, &'static str);

/// Refuses positions and orientations that make no sense as they are and do in another convention.
///
/// # Errors
/// [`CalibrationError::Reading`] that names the convention.
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let Some((part, rig, poses)) = tracked_part(device, recording) else {
        return Ok(());
    };
    let found =
        orientations(device, &part, &poses, &rig).map(|message| ("qw, qx, qy, qz", message));
    let found = found.or_else(|| Some(("x_m, y_m, z_m", positions(device, &part, &poses, &rig)?)));
    let found = found.or_else(|| Some(("x_m, y_m, z_m", inverted(device, &part, &poses, &rig)?)));
    let found = found.or_else(|| Some(("x_m, y_m, z_m", elsewhere(device, &part, &poses, &rig)?)));
    found.map_or(Ok(()), |(column, message)| {
        Err(refusal(recording, column, message))
    })
}

fn positions(device: &Device, recording: &Recording, poses: &[Pose], rig: &Rig) -> Option<String> {
    let mut alone = recording.clone();
    alone.orientation_wxyz = None;
    let seen = sights(&alone, poses, device, rig);
    let own = gross_m(&seen, rig)?;
    let mirrored = |mirror: &Matrix3<f64>| {
        let turned = seen.iter().map(|sight| Sight {
            position_m: sight.position_m.map(|position_m| mirror * position_m),
            ..*sight
        });
        error_m(&turned.collect::<Vec<Sight>>(), rig)
    };
    let tried = mirrors(rig.open.bases.contains(&true)).into_iter();
    let tried = tried.map(|(mirror, words)| (mirrored(&mirror), words));
    let (best, words) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best * BETTER < own).then(|| {
        format!(
            "{words}: the positions miss the device by {own:.3} m as they are, and by {best:.1e} m mirrored; give them \
             in right-handed axes (or correct the device file, if it describes the mirror image of the device)"
        )
    })
}

/// Root mean square error of positions by the frames that fit them best.
pub(crate) fn error_m(sights: &[Sight], rig: &Rig) -> f64 {
    let frames = closed_form(sights, rig);
    (missed(sights, &frames) / sights.len().max(1) as f64).sqrt()
}

/// The error of positions as they are, where it is gross.
fn gross_m(sights: &[Sight], rig: &Rig) -> Option<f64> {
    let own = error_m(sights, rig);
    let is_gross = sights.len() >= LEAST_ROWS && own > GROSS_SHARE * seen_spread_m(sights);
    is_gross.then_some(own)
}

/// The tracker's frame seen from the marker, in the place of the marker seen from the tracker.
fn inverted(device: &Device, recording: &Recording, poses: &[Pose], rig: &Rig) -> Option<String> {
    let seen = sights(recording, poses, device, rig);
    let own = gross_m(&seen, rig)?;
    let turned = seen.iter().map(|sight| {
        let back = sight.rotation?.transpose();
        Some(Sight {
            position_m: sight.position_m.map(|position_m| -(back * position_m)),
            rotation: Some(back),
            ..*sight
        })
    });
    let other = error_m(&turned.collect::<Option<Vec<Sight>>>()?, rig);
    (other * BETTER < own).then(|| {
        format!(
            "the poses are the inverse of those wanted (the tracker's frame seen from the marker): they miss the device by \
             {own:.3} m as they are, and by {other:.1e} m inverted; give the marker seen from the tracker"
        )
    })
}

/// Positions in a frame of the tracker's own, or of a marker that is not the handle, where both are said to be known.
fn elsewhere(device: &Device, recording: &Recording, poses: &[Pose], rig: &Rig) -> Option<String> {
    let around = &device.surroundings;
    let are_known = device
        .tracker
        .is_none_or(|tracker| tracker.base_known && tracker.tool_known);
    let is_placed = around.tracker_base.is_some() || around.tracker_tool.is_some();
    if !are_known || is_placed || rig.has_several() {
        return None;
    }
    let seen = sights(recording, poses, device, rig);
    let own = gross_m(&seen, rig)?;
    let unknown = |open: [bool; 2]| error_m(&seen, &rig.with_open(open));
    let tried = [
        ([true, false], "base = \"unknown\" in [tracker]"),
        ([false, true], "tool = \"unknown\" in [tracker]"),
        (
            [true, true],
            "base = \"unknown\" and tool = \"unknown\" in [tracker]",
        ),
    ];
    let tried = tried.map(|(open, words)| (unknown(open), words));
    let best = tried.iter().map(|(error, _)| *error).fold(own, f64::min);
    // of those that fit alike the one with the fewest unknowns
    let mut tried = tried.into_iter();
    let found = tried.find(|(error, _)| error * BETTER < own && *error <= AS_GOOD * best);
    found.map(|(error, words)| {
        format!(
            "the positions are not those of the handle in frame (-1): they miss the device by {own:.3} m, and by \
             {error:.1e} m with the tracker or its marker elsewhere; give {words}, in the device file or with --rig"
        )
    })
}

/// Refuses positions of runs between which the tracker was set up anew, where the device has one place for all: no fit of a device
/// makes sense of them. A diagnosis does, so it does not ask.
///
/// # Errors
/// [`CalibrationError::Reading`] that says how to state a place for each run.
///
/// ```
/// use haptical_calibration::check_stands;
/// use haptical_model::{Device, Recording};
/// let device = Device::from_toml("[[joint]]", "one.toml")?.device;
/// assert!(check_stands(&device, &Recording::default()).is_ok());
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
pub fn check_stands(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    let Some((part, rig, poses)) = tracked_part(device, recording) else {
        return Ok(());
    };
    let found = between_runs(device, &part, &poses, &rig);
    found.map_or(Ok(()), |message| {
        Err(refusal(recording, "x_m, y_m, z_m", message))
    })
}

fn refusal(recording: &Recording, column: &str, message: String) -> CalibrationError {
    CalibrationError::Reading {
        line: recording.line.first().copied().unwrap_or(0),
        column: column.to_owned(),
        message,
    }
}

/// Some of the rows that a tracker saw, what it knows of its places, and the handle's poses; none where there are none, or
/// where a row has no pose, which the fit names.
fn tracked_part(device: &Device, recording: &Recording) -> Option<(Recording, Rig, Vec<Pose>)> {
    let is_tracked = recording.position_m.is_some() || recording.orientation_wxyz.is_some();
    if !is_tracked {
        return None;
    }
    let rows = recording.len();
    let count = rows.min(MOST_ROWS);
    let some: Vec<usize> = (0..count).map(|index| index * rows / count).collect();
    let part = recording.select(&some);
    let rig = Rig::new(device, &part);
    let poses = handle_poses(device, &part).ok()?;
    Some((part, rig, poses))
}

/// Positions of runs between which the tracker was set up anew.
fn between_runs(
    device: &Device,
    recording: &Recording,
    poses: &[Pose],
    rig: &Rig,
) -> Option<String> {
    let runs = recording.run.as_ref()?;
    if device.has_run_bases() || runs.iter().all(|run| Some(run) == runs.first()) {
        return None;
    }
    let own = gross_m(&sights(recording, poses, device, rig), rig)?;
    let mut anew = device.clone();
    let tracker = anew.tracker.get_or_insert(Tracker {
        base_known: false,
        base_per_run: true,
        tool_known: true,
        position_sd_m: None,
        rotation_sd_rad: None,
        scale_sd: None,
    });
    (tracker.base_known, tracker.base_per_run) = (false, true);
    let rig = Rig::new(&anew, recording);
    let other = error_m(&sights(recording, poses, &anew, &rig), &rig);
    (other * BETTER < own).then(|| {
        format!(
            "the tracker did not stand in one place in all runs: the positions miss the device by {own:.3} m from one \
             place, and by {other:.1e} m with a place for each run; give base = \"per-run\" in [tracker], in the device \
             file or with --rig"
        )
    })
}

/// Spread of the positions seen.
pub(crate) fn seen_spread_m(sights: &[Sight]) -> f64 {
    let places: Vec<Vector3<f64>> = sights.iter().filter_map(|sight| sight.position_m).collect();
    spread_m(&places)
}

/// Seen from an unknown place all mirrors are one, turned.
fn mirrors(is_unknown: bool) -> Vec<Mirror> {
    let flip = |axis: usize| {
        let mut signs = Vector3::repeat(1.0);
        signs[axis] = -1.0;
        Matrix3::from_diagonal(&signs)
    };
    let swap = |a: usize, b: usize| {
        let mut matrix = Matrix3::identity();
        matrix.swap_rows(a, b);
        matrix
    };
    if is_unknown {
        let words = "the tracker's axes are left-handed (or one coordinate has the wrong sign, or two are swapped)";
        return vec![(flip(0), words)];
    }
    vec![
        (flip(0), "the tracker's x has the wrong sign"),
        (flip(1), "the tracker's y has the wrong sign"),
        (flip(2), "the tracker's z has the wrong sign"),
        (swap(0, 1), "the tracker's x and y are swapped"),
        (swap(0, 2), "the tracker's x and z are swapped"),
        (swap(1, 2), "the tracker's y and z are swapped"),
    ]
}

fn orientations(
    device: &Device,
    recording: &Recording,
    poses: &[Pose],
    rig: &Rig,
) -> Option<String> {
    let [w, x, y, z] = recording.orientation_wxyz.as_ref()?;
    let error = |columns: [&Vec<f64>; 4], is_inverse: bool| {
        let sign = if is_inverse { -1.0 } else { 1.0 };
        let [w, x, y, z] = columns;
        let part = |column: &[f64]| column.iter().map(|value| sign * value).collect();
        let turned = Recording {
            position_m: recording.position_m.clone(),
            orientation_wxyz: Some([w.clone(), part(x), part(y), part(z)]),
            line: recording.line.clone(),
            run: recording.run.clone(),
            hand: recording.hand.clone(),
            tool: recording.tool.clone(),
            ..Recording::default()
        };
        let seen = sights(&turned, poses, device, rig);
        let frames = closed_form(&seen, rig);
        // orientations alone may fit in two conventions, the base turned: positions tell
        let slid =
            (missed(&seen, &frames) / seen.len().max(1) as f64).sqrt() / seen_spread_m(&seen);
        let slid = if slid.is_finite() { slid } else { 0.0 };
        let angle = angle_rad(&seen, &frames);
        (seen.len() >= LEAST_ROWS).then(|| (angle, angle.hypot(slid)))
    };
    let (own, own_of_both) = error([w, x, y, z], false)?;
    if own <= GROSS_RAD && own_of_both <= GROSS_RAD.hypot(GROSS_SHARE) {
        return None;
    }
    let last = [z, w, x, y];
    let others = [
        (
            error(last, false)?,
            "the quaternions are stored as x, y, z, w",
        ),
        (
            error([w, x, y, z], true)?,
            "the quaternions are inverted (they turn the tracker's axes into the marker's, not the marker's into the \
             tracker's)",
        ),
        (
            error(last, true)?,
            "the quaternions are stored as x, y, z, w and inverted",
        ),
    ];
    let sizes = others.iter().map(|((_, both), _)| *both);
    let best = sizes.min_by(f64::total_cmp)?;
    let as_good = others
        .iter()
        .filter(|((_, both), _)| *both < AS_GOOD * best);
    let words: Vec<&str> = as_good.clone().map(|(_, words)| *words).collect();
    (best * BETTER < own_of_both).then(|| {
        format!(
            "{}: what the tracker saw misses the device by {own_of_both:.3} rad or as large a share of the positions' \
             spread as it is, and by {best:.1e} so; give the orientations as qw, qx, qy, qz of the marker seen from the \
             tracker",
            words.join(", or ")
        )
    })
}

/// Root mean square angle between what was seen and what the device has.
pub(crate) fn angle_rad(sights: &[Sight], frames: &Frames) -> f64 {
    let turned = sights.iter().filter_map(|sight| {
        let (base, tool) = (&frames.bases[sight.base], &frames.tools[sight.tool]);
        let have = base.rotation * sight.handle.rotation * tool.rotation;
        Some(rotation_vector(&(have.transpose() * sight.rotation?)).norm_squared())
    });
    (turned.sum::<f64>() / sights.len().max(1) as f64).sqrt()
}
