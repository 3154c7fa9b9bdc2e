//! Start values of a device's surroundings: tracker, touched points and planes.

use std::collections::BTreeSet;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{ContactPoint, Device, DeviceChain, Evaluation, Recording, TouchedPlane};

use crate::CalibrationError;
use crate::error::at_row;
use crate::problem::loads::Loads;
use crate::start::hand_eye::place_tracker;
use crate::start::hands::place_hands;
use crate::start::points::mean;

/// The device with a start value for everything around the chain that a recording shows and the device file
/// leaves open; what the file gives stays.
///
/// - The tracker, where its base or tool is unknown: in closed form from the device's own poses, then fitted with
///   the geometry held.
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
        return Ok(prepared);
    }
    let poses = handle_poses(device, recording)?;
    if has_tracker {
        match device.has_tool_per_hand() {
            true => place_hands(&mut prepared, recording, &poses)?,
            false => place_tracker(&mut prepared, recording, &poses)?,
        }
    }
    place_touches(&mut prepared, recording, &poses);
    Ok(prepared)
}

/// The ids of a column in the order in which they come, without empty ones.
pub(crate) fn listed(ids: &[String]) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let new = ids
        .iter()
        .filter(|id| !id.is_empty() && seen.insert(id.as_str()));
    new.cloned().collect()
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

fn place_touches(device: &mut Device, recording: &Recording, poses: &[Pose]) {
    let touches = |ids: &[String], id: &str| -> Vec<Vector3<f64>> {
        let touched = ids.iter().zip(poses).filter(|(other, _)| *other == id);
        touched.map(|(_, pose)| pose.position_m).collect()
    };
    let old = std::mem::take(&mut device.surroundings.contacts);
    for id in recording.contact.as_deref().map(listed).unwrap_or_default() {
        let known = old.iter().find(|point| point.id == id).cloned();
        let ids = recording.contact.as_deref().unwrap_or_default();
        let point = known.unwrap_or_else(|| ContactPoint {
            position_m: mean(&touches(ids, &id)).into(),
            id,
        });
        device.surroundings.contacts.push(point);
    }
    let old = std::mem::take(&mut device.surroundings.planes);
    for id in recording.plane.as_deref().map(listed).unwrap_or_default() {
        let known = old.iter().find(|plane| plane.id == id).cloned();
        let ids = recording.plane.as_deref().unwrap_or_default();
        let plane = known.unwrap_or_else(|| plane_through(id.clone(), &touches(ids, &id)));
        device.surroundings.planes.push(plane);
    }
}

/// The same device with points and planes at their best places for the recording's own touches: what a check on
/// rows that no fit saw compares with, where these touch something that the fit did not.
pub(crate) fn with_unseen_touches(
    device: &Device,
    recording: &Recording,
) -> Result<Device, CalibrationError> {
    let mut placed = device.clone();
    if device.has_links() && (recording.contact.is_some() || recording.plane.is_some()) {
        let poses = handle_poses(device, recording)?;
        place_touches(&mut placed, recording, &poses);
    }
    Ok(placed)
}

/// Plane of least squares: through the mean, its normal the direction of least spread.
fn plane_through(id: String, points: &[Vector3<f64>]) -> TouchedPlane {
    let middle = mean(points);
    let mut spread = Matrix3::zeros();
    for point in points {
        let out = point - middle;
        spread += out * out.transpose();
    }
    let axes = spread.symmetric_eigen();
    let normal = axes
        .eigenvectors
        .column(axes.eigenvalues.imin())
        .into_owned();
    let normal = normal.try_normalize(0.5).unwrap_or_else(Vector3::z);
    TouchedPlane {
        id,
        normal: normal.into(),
        tilt: [0.0; 2],
        offset_m: normal.dot(&middle),
    }
}
