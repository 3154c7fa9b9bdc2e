//! Start values of a device's surroundings: tracker, touched points and planes.

use std::collections::BTreeSet;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceChain, Evaluation, Recording};

use crate::CalibrationError;
use crate::error::at_row;
use crate::problem::loads::Loads;
use crate::problem::some_rows::some_of_long;
use crate::start::hand_eye::place_tracker;
use crate::start::touches::place_touches;

/// The device with a start value for everything around the chain that a recording shows and the device file
/// leaves open; what the file gives stays.
///
/// - The tracker, where its base or tool is unknown, each run's base and each tool that rows name: in closed form from
///   the device's own poses, then fitted with the geometry held.
/// - A tool that touches points, and these: by linear least squares.
/// - A touched point: the mean of the handle's positions at its touches.
/// - A touched plane: the plane of least squares through them.
/// - A cable whose exit guide is fitted: the direction of the handle at home as its exit axis.
///
/// Points and planes that the recording does not touch are left out. [`crate::fit_device`] and
/// [`crate::calibrate`] begin with this.
///
/// ```
/// use haptical_calibration::prepare_device;
/// use haptical_model::{Device, Recording};
/// let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.4\nd_m = 0.1\n";
/// let device = Device::from_toml(&format!("{row}{row}[[joint]]\n"), "lever.toml")?.device;
/// let recording = Recording {
///     line: vec![2, 3],
///     joint: vec![vec![0.5, 0.5]],
///     contact: Some(vec!["socket".to_owned(); 2]),
///     ..Recording::default()
/// };
/// let prepared = prepare_device(&device, &recording)?;
/// let socket = &prepared.surroundings.contacts[0];
/// let handle = haptical_model::DeviceChain::new(&device).pose(&[0.5])?.position_m;
/// assert!((socket.position_m[0] - handle.x).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no pose.
pub fn prepare_device(device: &Device, recording: &Recording) -> Result<Device, CalibrationError> {
    let mut prepared = device.clone();
    if !device.has_links() {
        return Ok(prepared);
    }
    place_exits(&mut prepared, recording)?;
    let has_tracker = recording.position_m.is_some() || recording.orientation_wxyz.is_some();
    let has_touches = recording.contact.is_some() || recording.plane.is_some();
    if !has_tracker && !has_touches {
        prepared.surroundings.contacts.clear();
        prepared.surroundings.planes.clear();
        prepared.surroundings.run_bases.clear();
        for tool in &mut prepared.surroundings.tools {
            tool.placement = None;
        }
        return Ok(prepared);
    }
    forget_absent(&mut prepared, recording);
    // start values: some rows of a long recording are enough
    let some = some_of_long(recording);
    let recording = some.as_ref().unwrap_or(recording);
    let poses = handle_poses(device, recording)?;
    if has_tracker {
        place_tracker(&mut prepared, recording, &poses)?;
    }
    place_touches(&mut prepared, recording, &poses);
    Ok(prepared)
}

/// Leaves runs and tools that a recording does not have without a place, so that no parameter is of theirs.
fn forget_absent(device: &mut Device, recording: &Recording) {
    let around = &device.surroundings;
    if around.run_bases.is_empty() && around.tools.is_empty() {
        return;
    }
    let rows = 0..recording.len();
    let tools: BTreeSet<String> = (rows.clone())
        .map(|row| device.tool_at(recording, row).to_owned())
        .collect();
    let runs: BTreeSet<i64> = rows.map(|row| recording.run_at(row)).collect();
    let around = &mut device.surroundings;
    around.run_bases.retain(|base| runs.contains(&base.run));
    for tool in &mut around.tools {
        tool.placement = tool.placement.filter(|_| tools.contains(&tool.id));
    }
}

/// Handle poses at every row.
pub(crate) fn handle_poses(
    device: &Device,
    recording: &Recording,
) -> Result<Vec<Pose>, CalibrationError> {
    let loads = Loads::new(device, recording)?;
    let mut evaluation = Evaluation::new(device);
    let mut readings = vec![0.0; device.joints.len()];
    let mut poses = Vec::with_capacity(recording.len());
    for row in 0..recording.len() {
        recording.read_joints(row, &mut readings);
        evaluation.choose_hand(device.hand_at(recording, row));
        if let Some(loads) = &loads {
            evaluation.set_torques(loads.of_row(row));
        }
        let moved = evaluation.move_pose_to(&readings);
        let pose = moved.and_then(|()| evaluation.pose().copied());
        poses.push(pose.map_err(at_row(recording, row))?);
    }
    Ok(poses)
}

fn place_exits(device: &mut Device, recording: &Recording) -> Result<(), CalibrationError> {
    let is_bent = |cable: &haptical_model::Cable| {
        (cable.fit.exit_radius || cable.exit_radius_m != 0.0) && cable.exit_axis.is_none()
    };
    if !device.cables.iter().any(is_bent) {
        return Ok(());
    }
    let home = vec![0.0; device.joints.len()];
    let pose = DeviceChain::new(device).pose(&home);
    let pose = pose.map_err(|source| at_row(recording, 0)(source.into()))?;
    for cable in device.cables.iter_mut().filter(|cable| is_bent(cable)) {
        let way = pose.position_m - Vector3::from(cable.anchor_m);
        cable.exit_axis = way.try_normalize(f64::MIN_POSITIVE).map(Into::into);
    }
    Ok(())
}

/// The same device with points and planes at their best places for the recording's own touches, and tools and tracker places
/// that it lacks for the recording's own readings: what a check on rows that no fit saw compares with, where these touch
/// something, or are of a run, that the fit did not see.
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no pose.
pub fn with_unseen_places(
    device: &Device,
    recording: &Recording,
) -> Result<Device, CalibrationError> {
    let mut placed = device.clone();
    let has_touches = recording.contact.is_some() || recording.plane.is_some();
    let lacks_mounts = device.mounts(recording).is_err();
    if device.has_links() && (has_touches || lacks_mounts) {
        let poses = handle_poses(device, recording)?;
        if lacks_mounts {
            place_tracker(&mut placed, recording, &poses)?;
        }
        place_touches(&mut placed, recording, &poses);
    }
    Ok(placed)
}
