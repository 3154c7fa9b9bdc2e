//! What sensors show at postures: exactly, and with their noise.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Quaternion, Rotation3, UnitQuaternion};
use haptical_model::{Device, Evaluation, Mount, Recording};

use crate::SimulatorError;
use crate::postures::sensors::{PostureSensors, UNSTATED_SD};
use crate::sensor::Sensor;
use crate::settings::{CableSigma, Noise, Settings};
use crate::simulate::{FIRST_LINE, finite};
use crate::streams::{Stream, normal};
use crate::track::{Then, noisy_orientation};

/// What every sensor shows without noise at the rows of `asked`, whose joint readings are exact.
pub(super) fn exact(
    truth: &Device,
    asked: &Recording,
    sensors: &PostureSensors,
    mounts: &[Mount],
) -> Result<Recording, SimulatorError> {
    let rows = asked.len();
    let mut recording = asked.clone();
    recording.line = (0..rows as u64).map(|row| FIRST_LINE + row).collect();
    let column = |is_there: bool| is_there.then(|| Vec::with_capacity(rows));
    recording.output = sensors.outputs.iter().map(|&is| column(is)).collect();
    recording.cable_m = sensors.cables.iter().map(|&is| column(is)).collect();
    recording.position_m = sensors.position.then(|| [(); 3].map(|()| Vec::new()));
    recording.orientation_wxyz = sensors.orientation.then(|| [(); 4].map(|()| Vec::new()));
    let mut evaluation = Evaluation::new(truth);
    let mut readings = vec![0.0; truth.joints.len()];
    for row in 0..rows {
        let refuse = |source| SimulatorError::Row { row, source };
        asked.read_joints(row, &mut readings);
        evaluation.choose_hand(truth.hand_at(asked, row));
        evaluation.move_pose_to(&readings).map_err(refuse)?;
        for (joint, column) in recording.output.iter_mut().enumerate() {
            if let Some(column) = column {
                column.push(evaluation.output_rad(joint));
            }
        }
        if !truth.has_links() {
            continue;
        }
        let pose = *evaluation.pose().map_err(refuse)?;
        // a cable ends at the handle, not at a tool
        let tool = truth.tool_at(asked, row);
        let has_cable = tool.is_empty() || truth.is_of_hand(tool);
        for (cable, column) in truth.cables.iter().zip(&mut recording.cable_m) {
            if let Some(column) = column {
                let read = cable.reading(&pose.position_m);
                let read = read.map_err(|source| refuse(source.into()))?;
                column.push(if has_cable { read.reading_m } else { f64::NAN });
            }
        }
        let seen = seen(truth, &pose, mounts.get(row).copied().unwrap_or_default());
        for (axis, column) in recording.position_m.iter_mut().flatten().enumerate() {
            column.push(seen.position_m[axis]);
        }
        let turn = Rotation3::from_matrix_unchecked(seen.rotation);
        let turn = UnitQuaternion::from_rotation_matrix(&turn).into_inner();
        let parts = [turn.w, turn.i, turn.j, turn.k];
        let columns = recording.orientation_wxyz.iter_mut().flatten();
        columns
            .zip(parts)
            .for_each(|(column, part)| column.push(part));
    }
    Ok(recording)
}

/// What the tracker sees of a handle.
fn seen(truth: &Device, handle: &Pose, mount: Mount) -> Pose {
    let place = |placement: Option<haptical_model::Placement>| {
        placement.map_or_else(Pose::default, |placement| placement.pose())
    };
    let base = place(truth.base_of(mount));
    base.then(handle).then(&place(truth.seen_tool_of(mount)))
}

/// Rounds and disturbs what sensors show, as the device describes them; a sensor without a stated noise has 0.1 mm or
/// 0.1 mrad, as a calibration takes it then.
pub(super) fn disturb(
    truth: &Device,
    recording: &mut Recording,
    seed: u64,
) -> Result<(), SimulatorError> {
    for (joint, column) in recording.joint.iter_mut().enumerate() {
        let described = &truth.joints[joint];
        if described.encoder_counts_per_rev.is_some() {
            let mut sensor = Sensor::motor(described, joint, &Settings::real_encoders())?;
            read_all(column, &mut sensor, ("theta", joint))?;
        }
    }
    for (joint, column) in recording.output.iter_mut().enumerate() {
        if let Some(column) = column {
            read_all(column, &mut output(truth, joint, seed)?, ("out", joint))?;
        }
    }
    for (index, column) in recording.cable_m.iter_mut().enumerate() {
        if let Some(column) = column {
            read_all(column, &mut cable(truth, index, seed)?, ("cable ", index))?;
        }
    }
    let (position_sd_m, rotation_sd_rad) = truth.tracker.map_or((None, None), |tracker| {
        (tracker.position_sd_m, tracker.rotation_sd_rad)
    });
    if let Some(axes) = &mut recording.position_m {
        for (axis, column) in axes.iter_mut().enumerate() {
            let generator = Stream::PosturePosition.open(axis, seed);
            let mut sensor = Sensor::noisy(position_sd_m.unwrap_or(UNSTATED_SD), generator);
            read_all(column, &mut sensor, ("position ", axis))?;
        }
    }
    if let Some(parts) = &mut recording.orientation_wxyz {
        let mut generator = Stream::PostureOrientation.open(0, seed);
        let sd_rad = rotation_sd_rad.unwrap_or(UNSTATED_SD);
        for row in 0..parts[0].len() {
            let [w, x, y, z] = parts.each_ref().map(|part| part[row]);
            let exact = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            let read = noisy_orientation(&exact.to_rotation_matrix(), sd_rad, &mut generator);
            for (part, value) in parts.iter_mut().zip(read) {
                part[row] = value;
            }
        }
    }
    Ok(())
}

/// Replaces true values by what a sensor shows; a cell without a value stays so, and takes its random numbers.
fn read_all(
    column: &mut [f64],
    sensor: &mut Sensor,
    (name, index): (&str, usize),
) -> Result<(), SimulatorError> {
    for (row, value) in column.iter_mut().enumerate() {
        let shown = sensor.read(*value) + 0.0;
        if !value.is_nan() {
            *value = finite(shown, row, name, index)?;
        }
    }
    Ok(())
}

fn output(truth: &Device, joint: usize, seed: u64) -> Result<Sensor, SimulatorError> {
    let generator = Stream::PostureOutput.open(joint, seed);
    let described = &truth.joints[joint];
    let noise = match described {
        own if own.external_encoder_sd_rad.is_some() => Noise::Gaussian,
        own if own.external_encoder_counts_per_rev.is_some() => Noise::Counts,
        _ => return Ok(Sensor::noisy(UNSTATED_SD, generator)),
    };
    Sensor::output(described, joint, noise, generator)
}

fn cable(truth: &Device, index: usize, seed: u64) -> Result<Sensor, SimulatorError> {
    let generator = Stream::PostureCable.open(index, seed);
    let described = &truth.cables[index];
    let has_counts = described.drum_radius_m.is_some() && described.counts_per_rev.is_some();
    let settings = match described.distance_sd_m {
        Some(_) => Settings {
            cable_sigma: CableSigma::Stated,
            ..Settings::paper()
        },
        None if has_counts => Settings::real_encoders(),
        None => return Ok(Sensor::noisy(UNSTATED_SD, generator)),
    };
    Sensor::cable(described, index, &settings, generator)
}

/// Three normal numbers of a posture's touch.
pub(super) fn touch_noise(rows: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut generator = Stream::Touch.open(0, seed);
    (0..rows)
        .map(|_| [(); 3].map(|()| normal(&mut generator)))
        .collect()
}

/// A normal number of each posture for a joint's fixture.
pub(super) fn fixture_noise(rows: usize, joint: usize, seed: u64) -> Vec<f64> {
    let mut generator = Stream::Fixture.open(joint, seed);
    (0..rows).map(|_| normal(&mut generator)).collect()
}
