//! `haptical.forward_kinematics`: handle poses of many postures.

use haptical::model::Evaluation;
use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;

use crate::device::device_of;
use crate::failure::Failure;

/// Positions and rotations of many postures.
type Poses<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);

/// Positions [N, 3] and rotations [N, 3, 3] of the handle in frame (-1), from readings [N, n].
#[pyfunction]
#[pyo3(signature = (device, readings, *, base=None, tip=None, rig=None))]
pub(crate) fn forward_kinematics<'py>(
    py: Python<'py>,
    device: &Bound<'py, PyAny>,
    readings: PyReadonlyArray2<'py, f64>,
    base: Option<&str>,
    tip: Option<&str>,
    rig: Option<&Bound<'py, PyAny>>,
) -> PyResult<Poses<'py>> {
    let device = device_of(device, (base, tip), rig)?;
    let readings = readings.as_array().to_owned();
    let (positions, rotations) = py.detach(|| poses(&device.read.model, &readings))?;
    Ok((positions.to_pyarray(py), rotations.to_pyarray(py)))
}

fn poses(
    device: &haptical::model::Device,
    readings: &Array2<f64>,
) -> Result<(Array2<f64>, Array3<f64>), Failure> {
    let (n_rows, n_columns) = readings.dim();
    let n_joints = device.joints.len();
    if n_columns != n_joints {
        return Err(Failure::value(format!(
            "the readings have {n_columns} columns, and the device has {n_joints} joints"
        )));
    }
    let mut positions = Array2::zeros((n_rows, 3));
    let mut rotations = Array3::zeros((n_rows, 3, 3));
    let mut evaluation = Evaluation::new(device);
    let mut row_readings = vec![0.0; n_joints];
    for row in 0..n_rows {
        for (reading, &given) in row_readings.iter_mut().zip(readings.row(row)) {
            *reading = given;
        }
        if let Some(joint) = row_readings.iter().position(|reading| !reading.is_finite()) {
            return Err(Failure::value(format!(
                "row {row}: the reading of joint {} is {}, and a finite number is expected",
                joint + 1,
                row_readings[joint]
            )));
        }
        evaluation
            .move_pose_to(&row_readings)
            .map_err(|error| Failure::value(format!("row {row}: {error}")))?;
        let pose = evaluation.pose()?;
        for axis in 0..3 {
            positions[[row, axis]] = pose.position_m[axis];
            for column in 0..3 {
                rotations[[row, axis, column]] = pose.rotation[(axis, column)];
            }
        }
    }
    Ok((positions, rotations))
}
