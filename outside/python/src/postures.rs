//! Many postures at once: joint values, poses, Jacobians, torques that hold or move the arm, what effects do to the handle.

use haptical::model::{Device as Model, Evaluation, Recording, RigidBodies, holding_torques_nm};
use haptical::{Device, Log, Waypoints, rest_poses};
use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;

use crate::device::{Tips, device_of};
use crate::failure::Failure;

/// Positions \[N, 3\] and rotations \[N, 3, 3\], before they are arrays of Python.
type Made = (Array2<f64>, Array3<f64>);
/// Positions and rotations of many postures.
type Poses<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);
type Readings<'py> = PyReadonlyArray2<'py, f64>;

/// Readings that are finite, one column for each joint.
fn checked(model: &Model, readings: &Readings<'_>, what: &str) -> Result<Array2<f64>, Failure> {
    let readings = readings.as_array().to_owned();
    let (columns, joints) = (readings.ncols(), model.joints.len());
    if columns != joints {
        return Err(Failure::value(format!(
            "the {what} have {columns} columns, and the device has {joints} joints"
        )));
    }
    let odd = readings
        .indexed_iter()
        .find(|(_, value)| !value.is_finite());
    if let Some(((row, joint), value)) = odd {
        return Err(Failure::value(format!(
            "row {row}: the reading of joint {} is {value}, and a finite number is expected",
            joint + 1
        )));
    }
    Ok(readings)
}

/// Moves a device through postures and takes something of each.
fn at_each(
    model: &Model,
    readings: &Array2<f64>,
    mut take: impl FnMut(usize, &Evaluation<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut evaluation = Evaluation::new(model);
    for (row, own) in readings.rows().into_iter().enumerate() {
        let moved = evaluation.move_to(&own.to_vec());
        moved.map_err(|error| Failure::value(format!("row {row}: {error}")))?;
        take(row, &evaluation)?;
    }
    Ok(())
}

fn recording(readings: &Array2<f64>) -> Recording {
    let columns = readings.columns().into_iter().map(|own| own.to_vec());
    Recording {
        line: (2..).take(readings.nrows()).collect(),
        joint: columns.collect(),
        output: vec![None; readings.ncols()],
        torque_nm: vec![None; readings.ncols()],
        ..Recording::default()
    }
}

/// Positions \[N, 3\] and rotations \[N, 3, 3\] of the handle in frame (-1), from readings [N, n]; with what the arm yields at rest
/// and the effects of its postures where that is asked for.
#[pyfunction]
#[pyo3(signature = (device, readings, *, effects=false, base=None, tip=None, rig=None))]
pub(crate) fn forward_kinematics<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    readings: Readings<'py>,
    effects: bool,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Poses<'py>> {
    let device = device_of(device, (base, tip), rig)?;
    let readings = checked(&device.read.model, &readings, "readings")?;
    let ((positions, rotations), warnings) = py.detach(|| match effects {
        true => bent(&device.read, &readings),
        false => Ok((rigid(&device.read.model, &readings)?, Vec::new())),
    })?;
    for warning in warnings {
        py.import("warnings")?.call_method1("warn", (warning,))?;
    }
    Ok((positions.to_pyarray(py), rotations.to_pyarray(py)))
}

fn rigid(model: &Model, readings: &Array2<f64>) -> Result<Made, Failure> {
    let rows = readings.nrows();
    let (mut positions, mut rotations) = (Array2::zeros((rows, 3)), Array3::zeros((rows, 3, 3)));
    let mut evaluation = Evaluation::new(model);
    for (row, own) in readings.rows().into_iter().enumerate() {
        let moved = evaluation.move_pose_to(&own.to_vec());
        moved.map_err(|error| Failure::value(format!("row {row}: {error}")))?;
        let pose = evaluation.pose()?;
        put(
            &mut positions,
            &mut rotations,
            row,
            &pose.position_m.into(),
            &|r, c| pose.rotation[(r, c)],
        );
    }
    Ok((positions, rotations))
}

/// With what is left out.
fn bent(device: &Device, readings: &Array2<f64>) -> Result<(Made, Vec<String>), Failure> {
    let rows = readings.nrows();
    let log = Log::from_recording(recording(readings), "the readings", device)?;
    let found = rest_poses(device, &Waypoints::from_log(log)?)?;
    let (mut positions, mut rotations) = (Array2::zeros((rows, 3)), Array3::zeros((rows, 3, 3)));
    for (row, pose) in found.poses.iter().enumerate() {
        put(
            &mut positions,
            &mut rotations,
            row,
            &pose.position_m.into(),
            &|r, c| pose.rotation[(r, c)],
        );
    }
    Ok(((positions, rotations), found.warnings))
}

fn put(
    positions: &mut Array2<f64>,
    rotations: &mut Array3<f64>,
    row: usize,
    position: &[f64; 3],
    rotation: &dyn Fn(usize, usize) -> f64,
) {
    for axis in 0..3 {
        positions[[row, axis]] = position[axis];
        for column in 0..3 {
            rotations[[row, axis, column]] = rotation(axis, column);
        }
    }
}

/// Values of the joints behind their transmissions [N, n], from readings [N, n].
#[pyfunction]
#[pyo3(signature = (device, readings, *, base=None, tip=None, rig=None))]
pub(crate) fn joint_values<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    readings: Readings<'py>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let device = device_of(device, (base, tip), rig)?;
    let readings = checked(&device.read.model, &readings, "readings")?;
    let values = py.detach(|| -> Result<Array2<f64>, Failure> {
        let mut values = readings.clone();
        for (joint, own) in device.read.model.joints.iter().enumerate() {
            for (row, value) in values.column_mut(joint).iter_mut().enumerate() {
                let error = own.error_rad(*value);
                *value += error.map_err(|error| {
                    Failure::value(format!("row {row}, joint {}: {error}", joint + 1))
                })?;
            }
        }
        Ok(values)
    })?;
    Ok(values.to_pyarray(py))
}

/// Derivatives of the handle's pose by each reading [N, 6, n]: the way, then the turn, in frame (-1).
#[pyfunction]
#[pyo3(signature = (device, readings, *, base=None, tip=None, rig=None))]
pub(crate) fn jacobian<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    readings: Readings<'py>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let device = device_of(device, (base, tip), rig)?;
    let model = &device.read.model;
    let readings = checked(model, &readings, "readings")?;
    let jacobians = py.detach(|| -> Result<Array3<f64>, Failure> {
        let mut all = Array3::zeros((readings.nrows(), 6, readings.ncols()));
        at_each(model, &readings, |row, evaluation| {
            evaluation.pose()?;
            for joint in 0..readings.ncols() {
                let twist = evaluation.reading_twist(joint);
                for axis in 0..3 {
                    all[[row, axis, joint]] = twist.linear[axis];
                    all[[row, axis + 3, joint]] = twist.angular[axis];
                }
            }
            Ok(())
        })?;
        Ok(all)
    })?;
    Ok(jacobians.to_pyarray(py))
}

/// Torques of the drives [N, n]: those that hold the arm's masses, or with velocities and accelerations those of the motion.
#[pyfunction]
#[pyo3(signature = (device, readings, velocities=None, accelerations=None, *, base=None, tip=None, rig=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn torques<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    readings: Readings<'py>,
    velocities: Option<Readings<'py>>,
    accelerations: Option<Readings<'py>>,
    base: Option<&str>,
    tip: Option<Tips>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let device = device_of(device, (base, tip), rig)?;
    let model = &device.read.model;
    let readings = checked(model, &readings, "readings")?;
    let rates = [
        velocities
            .map(|own| checked(model, &own, "velocities"))
            .transpose()?,
        accelerations
            .map(|own| checked(model, &own, "accelerations"))
            .transpose()?,
    ];
    for own in rates.iter().flatten() {
        if own.nrows() != readings.nrows() {
            let text = format!(
                "velocities or accelerations have {} rows, the readings {}",
                own.nrows(),
                readings.nrows()
            );
            return Err(Failure::value(text).into());
        }
    }
    let torques = py.detach(|| match rates {
        [None, None] => holding(model, &readings),
        [velocities, accelerations] => moving(model, &readings, &velocities, &accelerations),
    })?;
    Ok(torques.to_pyarray(py))
}

fn holding(model: &Model, readings: &Array2<f64>) -> Result<Array2<f64>, Failure> {
    let columns = holding_torques_nm(model, &recording(readings));
    let columns = columns.map_err(|error| Failure::value(error.to_string()))?;
    let columns = columns.ok_or_else(|| {
        Failure::value("the device has no masses with [gravity]: give mass_kg and centre_of_mass_m of its links")
    })?;
    Ok(Array2::from_shape_fn(readings.dim(), |(row, joint)| {
        columns[joint][row]
    }))
}

fn moving(
    model: &Model,
    readings: &Array2<f64>,
    velocities: &Option<Array2<f64>>,
    accelerations: &Option<Array2<f64>>,
) -> Result<Array2<f64>, Failure> {
    let bodies = RigidBodies::of_device(model)?;
    let mut work = bodies.work();
    let mut torques = Array2::zeros(readings.dim());
    let at = |own: &Option<Array2<f64>>, row: usize| match own {
        Some(own) => own.row(row).to_vec(),
        None => vec![0.0; readings.ncols()],
    };
    for row in 0..readings.nrows() {
        // bodies move with what is behind the transmissions
        let own_row = readings.row(row).to_vec();
        let angles = own_row.iter().zip(&model.joints);
        let angles = angles.map(|(reading, own)| Ok(reading + own.error_rad(*reading)?));
        let angles: Result<Vec<f64>, haptical::transmission::LawError> = angles.collect();
        let angles = angles.map_err(|error| Failure::value(format!("row {row}: {error}")))?;
        let mut own = vec![0.0; readings.ncols()];
        let (rate, change) = (at(velocities, row), at(accelerations, row));
        bodies.torques(&angles, &rate, &change, &mut work, &mut own)?;
        for (joint, torque) in own.into_iter().enumerate() {
            torques[[row, joint]] = torque;
        }
    }
    Ok(torques)
}
