//! Joints whose readings are wrong by what has to be searched for: a gear between reading and angle, and an encoder that does not
//! answer.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Recording};

use super::hypotheses::{Hypothesis, UNITS, column, scale};
use super::misses::{LEAST_ROWS, Misses, RATIO_OFF};
use crate::checks::stuck::is_one;
use crate::problem::measurement::rotation::rotation_vector;
use crate::problem::some_rows::spread_rows;
use crate::start::hand_eye::closed_form;
use crate::start::prepare::handle_poses;
use crate::start::sights::{Rig, Sight, sights};

const ANSWERS: &str = "record again with an encoder of that joint that answers";

/// Rows on which a gear is searched.
const SEARCHED_ROWS: usize = 24;
/// Largest gear that is searched for, either way.
const MOST_GEAR: f64 = 400.0;
/// Ratio of two gears that are tried. A range of 1 rad is off by 0.03 rad at most between them.
const STEP: f64 = 1.06;
/// Halvings of the step around the best gear.
const HALVINGS: usize = 24;
/// Rounds of places and angles in turn, and the largest step of an angle \[rad or m\].
const ROUNDS: usize = 40;
const MOST_STEP: f64 = 0.3;
/// Step of a numeric derivative \[rad or m\].
const SMALL: f64 = 1e-5;

/// Readings of a joint times a gear, and the readings that the tracker shows of a joint with one value throughout.
pub(super) fn of_joints<'a>(
    device: &'a Device,
    recording: &'a Recording,
    rows: &[usize],
) -> Vec<Hypothesis<'a>> {
    let joints = 0..device.joints.len();
    let some = recording.select(rows);
    let (still, moving): (Vec<usize>, Vec<usize>) =
        joints.partition(|&joint| is_one(some.joint[joint].iter()));
    let mut all: Vec<Hypothesis<'a>> = Vec::new();
    all.extend(
        moving
            .into_iter()
            .filter_map(|joint| geared(device, &some, joint)),
    );
    all.extend(still.into_iter().map(|joint| unread(device, joint)));
    all
}

/// The gear with which a joint misses least.
fn geared<'a>(device: &Device, some: &Recording, joint: usize) -> Option<Hypothesis<'a>> {
    let few = some.select(&spread_rows(some.len(), SEARCHED_ROWS));
    let missed = |log: &Recording, gear: f64| {
        let mut geared = log.clone();
        scale(&mut geared.joint[joint], gear);
        let misses = Misses::new(device, &geared);
        match misses.any() {
            true => misses.total(|_| true),
            false => f64::INFINITY,
        }
    };
    let steps = (MOST_GEAR.ln() / STEP.ln()).ceil() as i32;
    let tried = (-steps..=steps).flat_map(|step| [1.0, -1.0].map(|sign| sign * STEP.powi(step)));
    let tried = tried.map(|gear| (gear, missed(&few, gear)));
    let (mut gear, _) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (mut least, mut ratio) = (missed(some, gear), STEP);
    for _ in 0..HALVINGS {
        ratio = ratio.sqrt();
        for near in [gear * ratio, gear / ratio] {
            let miss = missed(some, near);
            if miss < least {
                (gear, least) = (near, miss);
            }
        }
    }
    // what is nearer is the drive's ratio, which a fit finds
    if (gear - 1.0).abs() < RATIO_OFF {
        return None;
    }
    let name = column(device, "theta", joint);
    let what = match gear.abs() < 1.0 {
        true => format!("column {name} divided by {:.5}", 1.0 / gear),
        false => format!("column {name} times {gear:.5}"),
    };
    let change = move |log: &mut Recording| scale(&mut log.joint[joint], gear);
    Some(Hypothesis::of_columns(what, UNITS, change).with_numbers(1))
}

/// A joint whose readings are those that the tracker's rows show.
fn unread(device: &Device, joint: usize) -> Hypothesis<'_> {
    let name = column(device, "theta", joint);
    let what =
        format!("column {name} as the tracker shows that joint, and not of one value throughout");
    let change = move |log: &mut Recording| {
        if let Some(angles) = shown(device, log, joint) {
            log.joint[joint] = angles;
        }
    };
    Hypothesis::of_columns(what, ANSWERS, change).with_numbers(1)
}

/// Readings of a joint with which each row's pose is nearest to what the tracker saw of it, next to the tracker's places that these
/// readings ask for. None where no tracker saw the rows: one number a row explains one distance whatever the joint does.
fn shown(device: &Device, recording: &Recording, joint: usize) -> Option<Vec<f64>> {
    let rig = Rig::new(device, recording);
    let mut log = recording.clone();
    for _ in 0..ROUNDS {
        let poses = handle_poses(device, &log).ok()?;
        let seen = sights(&log, &poses, device, &rig);
        if seen.len() < LEAST_ROWS {
            return None;
        }
        let frames = closed_form(&seen, &rig);
        let mut further = log.clone();
        further.joint[joint]
            .iter_mut()
            .for_each(|angle| *angle += SMALL);
        let moved = handle_poses(device, &further).ok()?;
        for sight in &seen {
            let (base, tool) = (&frames.bases[sight.base], &frames.tools[sight.tool]);
            let at = |handle: &Pose| off(sight, base, handle, tool);
            let (here, next) = (at(&sight.handle), at(&moved[sight.row]));
            let slopes = here
                .iter()
                .zip(&next)
                .map(|(here, next)| (next - here) / SMALL);
            let pairs = slopes.zip(&here).map(|(slope, here)| (slope, *here));
            let (square, product) = pairs.fold((0.0, 0.0), |(square, product), (slope, here)| {
                (square + slope.norm_squared(), product + slope.dot(&here))
            });
            let step = (product / square.max(f64::MIN_POSITIVE)).clamp(-MOST_STEP, MOST_STEP);
            log.joint[joint][sight.row] -= step;
        }
    }
    Some(log.joint.swap_remove(joint))
}

/// How far a handle's pose is from what the tracker saw \[m, rad\].
fn off(sight: &Sight, base: &Pose, handle: &Pose, tool: &Pose) -> [Vector3<f64>; 2] {
    let turned: Matrix3<f64> = base.rotation * handle.rotation;
    let place_m = base.position_m + base.rotation * handle.position_m + turned * tool.position_m;
    let place_m = sight.position_m.map(|seen_m| place_m - seen_m);
    let turn = |seen: Matrix3<f64>| rotation_vector(&(turned * tool.rotation * seen.transpose()));
    [
        place_m.unwrap_or_default(),
        sight.rotation.map(turn).unwrap_or_default(),
    ]
}
