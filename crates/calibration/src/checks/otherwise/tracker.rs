//! What a tracker's columns may have been written as, and where it may be.

use haptical_model::kinematics::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use haptical_model::{Device, Recording, Tracker};

use super::hypotheses::Hypothesis;
use crate::start::sights::Rig;

const RIGHT_HANDED: &str = "give right-handed axes (or correct the device file, if it describes the mirror image of the device)";
const POSES: &str =
    "give the marker seen from the tracker: its position, and its orientation as qw, qx, qy, qz";
const PLACES: &str = "say so in the device file or with --rig";

/// Signs and order of the axes and of the quaternions, poses the other way round, another frame.
pub(super) fn of_tracker<'a>(device: &Device, recording: &'a Recording) -> Vec<Hypothesis<'a>> {
    let mut all = Vec::new();
    let has_turns = recording.orientation_wxyz.is_some();
    if recording.position_m.is_some() {
        all.extend(mirrors(device, recording));
        all.extend(of_places(device, recording));
    }
    let mut add = |what: &str, change: Box<dyn Fn(&mut Recording)>| {
        all.push(Hypothesis::of_columns(what.to_owned(), POSES, change));
    };
    if has_turns {
        add(
            "the quaternions read as x, y, z, w",
            Box::new(|log| change_turns(log, last)),
        );
        add(
            "the quaternions inverted",
            Box::new(|log| change_turns(log, inverse)),
        );
        let both = |turn| inverse(last(turn));
        add(
            "the quaternions read as x, y, z, w and inverted",
            Box::new(move |log| change_turns(log, both)),
        );
        add(
            "the poses inverted, which are the tracker's frame seen from the marker",
            Box::new(invert),
        );
    }
    all
}

fn last([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [w, x, y, z]
}

fn inverse([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [w, -x, -y, -z]
}

/// Changes the quaternion of each row.
fn change_turns(log: &mut Recording, change: impl Fn([f64; 4]) -> [f64; 4]) {
    let Some(columns) = &mut log.orientation_wxyz else {
        return;
    };
    for row in 0..columns[0].len() {
        let changed = change(columns.each_ref().map(|column| column[row]));
        columns
            .iter_mut()
            .zip(changed)
            .for_each(|(column, part)| column[row] = part);
    }
}

/// Changes the position of each row, which is given with it.
fn change_positions(log: &mut Recording, change: impl Fn(usize, Vector3<f64>) -> Vector3<f64>) {
    let Some(columns) = &mut log.position_m else {
        return;
    };
    for row in 0..columns[0].len() {
        let changed = change(
            row,
            Vector3::from(columns.each_ref().map(|column| column[row])),
        );
        columns
            .iter_mut()
            .zip(&changed)
            .for_each(|(column, part)| column[row] = *part);
    }
}

/// The tracker's frame seen from the marker, in the place of the marker seen from the tracker.
fn invert(log: &mut Recording) {
    let turns = log.orientation_wxyz.clone().unwrap_or_default();
    change_turns(log, inverse);
    change_positions(log, |row, position_m| {
        let [w, x, y, z] = turns
            .each_ref()
            .map(|column| column.get(row).copied().unwrap_or(f64::NAN));
        -(UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).inverse() * position_m)
    });
}

/// Left-handed axes, of positions alone and of orientations too.
///
/// A mirror M of positions makes M R M^T of a rotation R: its axis v becomes -M v, as det M = -1. Seen from an unknown place all
/// mirrors are one, turned, unless orientations alone are right.
fn mirrors<'a>(device: &Device, recording: &Recording) -> Vec<Hypothesis<'a>> {
    let names = ["`x_m`", "`y_m`", "`z_m`"];
    let flip = |axis: usize| {
        let mut matrix = Matrix3::identity();
        matrix[(axis, axis)] = -1.0;
        (format!("{} negated", names[axis]), matrix)
    };
    let swap = |[a, b]: [usize; 2]| {
        let mut matrix = Matrix3::identity();
        matrix.swap_rows(a, b);
        (format!("{} and {} swapped", names[a], names[b]), matrix)
    };
    let any = (
        "the tracker's axes mirrored, which are left-handed (one coordinate negated, or two swapped)".to_owned(),
        flip(0).1,
    );
    let each = || {
        [
            flip(0),
            flip(1),
            flip(2),
            swap([0, 1]),
            swap([0, 2]),
            swap([1, 2]),
        ]
    };
    let open = Rig::new(device, recording).open;
    let [base, tool] = [open.bases, open.tools].map(|places| places.contains(&true));
    let has_turns = recording.orientation_wxyz.is_some();
    let of_positions = |(what, matrix): (String, Matrix3<f64>)| {
        let change =
            move |log: &mut Recording| change_positions(log, |_, position_m| matrix * position_m);
        Hypothesis::of_columns(what, RIGHT_HANDED, change)
    };
    let of_poses = |(what, matrix): (String, Matrix3<f64>)| {
        let change = move |log: &mut Recording| {
            change_positions(log, |_, position_m| matrix * position_m);
            change_turns(log, |[w, x, y, z]| {
                let axis = -(matrix * Vector3::new(x, y, z));
                [w, axis.x, axis.y, axis.z]
            });
        };
        Hypothesis::of_columns(format!("{what}, orientations too"), RIGHT_HANDED, change)
    };
    let mut all: Vec<Hypothesis<'_>> = match base && !has_turns {
        true => vec![of_positions(any.clone())],
        false => each().map(of_positions).into(),
    };
    match base && tool {
        _ if !has_turns => {}
        true => all.push(of_poses(any)),
        false => all.extend(each().map(of_poses)),
    }
    all
}

/// Positions in another frame of the tracker, or of a marker that is not the handle, where both are said to be known.
fn of_places(device: &Device, recording: &Recording) -> Vec<Hypothesis<'static>> {
    let around = &device.surroundings;
    let are_known = device
        .tracker
        .is_none_or(|tracker| tracker.base_known && tracker.tool_known);
    let is_placed = around.tracker_base.is_some() || around.tracker_tool.is_some();
    if !are_known || is_placed || Rig::new(device, recording).has_several() {
        return Vec::new();
    }
    let unknown = |(base, tool, what): (bool, bool, &str)| {
        let numbers = 6 * usize::from(base) + 6 * usize::from(tool);
        Hypothesis::of_device(
            format!("{what} in [tracker]"),
            PLACES,
            numbers,
            move |device| {
                let tracker = tracker_of(device);
                (tracker.base_known, tracker.tool_known) = (!base, !tool);
            },
        )
    };
    let all = [
        (true, false, "base = \"unknown\""),
        (false, true, "tool = \"unknown\""),
        (true, true, "base = \"unknown\" and tool = \"unknown\""),
    ];
    all.map(unknown).into()
}

/// A tracker that was set up anew between runs.
pub(super) fn of_runs(device: &Device, recording: &Recording) -> Vec<Hypothesis<'static>> {
    let runs = recording.run.as_ref().map_or(&[][..], Vec::as_slice);
    let is_one = runs.iter().all(|run| Some(run) == runs.first());
    if device.has_run_bases() || is_one {
        return Vec::new();
    }
    let mut runs = runs.to_vec();
    runs.dedup();
    let what =
        "base = \"per-run\" in [tracker]: it did not stand in one place in all runs".to_owned();
    vec![Hypothesis::of_device(
        what,
        PLACES,
        6 * runs.len(),
        |device| {
            let tracker = tracker_of(device);
            (tracker.base_known, tracker.base_per_run) = (false, true);
        },
    )]
}

/// The device's tracker; without one what is seen is the handle in frame (-1).
fn tracker_of(device: &mut Device) -> &mut Tracker {
    device.tracker.get_or_insert(Tracker {
        base_known: true,
        base_per_run: false,
        tool_known: true,
        position_sd_m: None,
        rotation_sd_rad: None,
        scale_sd: None,
    })
}
