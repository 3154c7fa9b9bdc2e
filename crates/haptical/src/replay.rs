//! A recorded motion through a model: what its channels should have read.

use haptical_calibration::{
    CalibrationError, Channel, ChannelResiduals, Weights, channel_residuals, channels,
    prepare_device,
};
use haptical_data::{LogColumn, LogShape};
use haptical_diagnosis::with_carried_loads;
use haptical_effects::device::{attached, handle_moved_m};
use haptical_kinematics::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use haptical_model::{DriveNumber, Recording, drive_numbers_in_words};
use haptical_motion::unwrapped;
use serde::Serialize;

use crate::columns::columns_of;
use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// What a model predicts of a log.
#[derive(Debug)]
pub struct Replayed {
    /// The log with what the model predicts in the place of what was measured.
    pub predicted: Recording,
    /// Channel by channel.
    pub channels: Vec<ReplayedChannel>,
    /// What is not predicted, and what is odd.
    pub warnings: Vec<String>,
}

/// One channel of a replay.
#[derive(Debug, Clone, Serialize)]
pub struct ReplayedChannel {
    /// `out2`, `cable`, `position`, `orientation`.
    pub channel: String,
    /// SI unit.
    pub unit: String,
    /// Readings, each with all its axes.
    pub readings: usize,
    /// Root mean square of prediction minus measurement, of one axis.
    pub rms: f64,
    /// The same of the noise that the device file states.
    pub noise_floor: f64,
    /// Prediction minus measurement, by row: axis after axis.
    #[serde(skip)]
    pub residuals: Vec<(usize, Vec<f64>)>,
    /// Columns of its axes; none of an orientation, whose parts are no residuals.
    #[serde(skip)]
    columns: Vec<LogColumn>,
}

/// What a page draws of a log: the recording with what the effects of a device add to it, and how far they move its handle.
#[derive(Debug)]
pub struct Drawn {
    /// With [`Recording::added`].
    pub recording: Recording,
    /// Row by row, in frame (-1) \[m\]; none without an effect that moves it.
    pub handle_moved_m: Option<Vec<[f64; 3]>>,
}

/// The effects of `device` over a log. `placed` is the device's model with its tracker placed, and gets the numbers that
/// are fitted.
///
/// # Errors
/// An effect lacks what drives it.
pub fn drawn(
    placed: &mut haptical_model::Device,
    (device, log): (&std::path::Path, &std::path::Path),
    recording: &Recording,
) -> Result<Drawn, Error> {
    let refuse = |error| Error::effect(&error, device, log);
    let handle_moved_m = handle_moved_m(placed, recording).map_err(refuse)?;
    let recording = attached(placed, recording).map_err(refuse)?.into_owned();
    Ok(Drawn {
        recording,
        handle_moved_m,
    })
}

/// Runs the motion, the loads and the times of a log through a device with its effects.
///
/// External encoders, cables, positions and orientations are predicted; what touches something is not.
///
/// # Errors
/// The device has no value at a row, an effect lacks what drives it, or nothing that the log measures can be predicted.
pub fn replay(device: &Device, log: &Log) -> Result<Replayed, Error> {
    let (device_path, log_path) = (&device.source().path, &log.source().path);
    let refuse = |error: &CalibrationError| {
        Error::calibration(error, device_path, log_path).with_equipment(device)
    };
    let mut warnings = Vec::new();
    // of a log of torques: an encoder that begins anew at a whole turn, as a diagnosis reads it
    let has_torques = log.recording.torque_nm.iter().any(Option::is_some);
    let straight = has_torques.then(|| unwrapped(&device.model, &log.recording));
    let straight = straight.flatten().map(|(straight, _)| straight);
    let recording = straight.as_ref().unwrap_or(&log.recording);
    let mut seen_from_base = device.model.clone();
    if is_corrected_path(recording) && seen_from_base.tracker.is_some() {
        seen_from_base.track_handle_in_base();
        warnings.push(
            "the log is a path that was corrected: its poses are the handle's in the frame of the base, not the tracker's".to_owned(),
        );
    }
    let (mut model, placed) = placed(&seen_from_base, recording).map_err(|error| refuse(&error))?;
    if placed {
        warnings.push(
            "the device file does not say where the tracker stands or what it sees: both are fitted to this log".to_owned(),
        );
    }
    warnings.extend(said_of_torques(&model, recording));
    let (residuals, unpredicted) =
        predicted_residuals(&mut model, recording, (device_path, log_path))
            .map_err(|error| error.with_equipment(device))?;
    if !unpredicted.is_empty() {
        warnings.insert(0, format!("not predicted: {}", unpredicted.join(", ")));
    }
    let mut predicted = recording.clone();
    let mut told = Vec::new();
    for own in &residuals {
        let width = own.channel.width();
        let rows = own.rows.iter().zip(own.residuals.chunks_exact(width));
        let rows = rows.map(|(row, values)| (*row, values.to_vec()));
        let rows: Vec<(usize, Vec<f64>)> = rows.collect();
        blank(&mut predicted, own.channel, &rows);
        put(&mut predicted, own.channel, &rows);
        if own.outside_range > 0 {
            warnings.push(format!(
                "{}: {} readings lie outside the range that a polynomial was fitted on and are not predicted",
                own.channel.name(),
                own.outside_range
            ));
        }
        told.push(ReplayedChannel {
            channel: own.channel.name(),
            unit: own.channel.unit(&model).to_owned(),
            readings: rows.len(),
            rms: own.rms().unwrap_or(0.0),
            noise_floor: own.noise_floor,
            residuals: rows,
            columns: match own.channel {
                Channel::Orientation => Vec::new(),
                channel => columns_of(channel),
            },
        });
    }
    Ok(Replayed {
        predicted,
        channels: told,
        warnings,
    })
}

/// Numbers of the readings of torques, which a replay takes as they are.
fn said_of_torques(model: &haptical_model::Device, recording: &Recording) -> Option<String> {
    recording.torque_nm.iter().flatten().next()?;
    let numbers = [DriveNumber::TorqueOffset, DriveNumber::TorqueDelay];
    let joints = drive_numbers_in_words(&model.joints, &numbers)?;
    Some(format!(
        "torques are loads here as they are logged: left out are {joints}"
    ))
}

/// Whether [`crate::correct`] wrote the recording: its poses are wanted ones, seen from the base.
fn is_corrected_path(recording: &Recording) -> bool {
    let mut columns = recording.covariates.iter();
    columns.any(|(name, _)| name == crate::correct::REST_COLUMN)
}

/// The model with its tracker placed, and whether that had to be fitted to the recording.
pub(crate) fn placed(
    model: &haptical_model::Device,
    recording: &Recording,
) -> Result<(haptical_model::Device, bool), CalibrationError> {
    let found = channels(model, recording)?;
    let mut found = found.iter();
    let is_seen = found.any(|channel| matches!(channel, Channel::Position | Channel::Orientation));
    let is_open = model.tracker.is_some_and(|tracker| {
        let around = &model.surroundings;
        (!tracker.base_known && around.tracker_base.is_none() && around.run_bases.is_empty())
            || (!tracker.tool_known && around.tracker_tool.is_none())
    });
    match is_seen && is_open {
        true => Ok((prepare_device(model, recording)?, true)),
        false => Ok((model.clone(), false)),
    }
}

/// Prediction minus measurement of every channel that can be predicted, effects of the device included, and the names of the
/// channels that cannot. `model` has its tracker placed, and gets the numbers that are fitted.
pub(crate) fn predicted_residuals(
    model: &mut haptical_model::Device,
    recording: &Recording,
    (device, log): (&std::path::Path, &std::path::Path),
) -> Result<(Vec<ChannelResiduals>, Vec<String>), Error> {
    let refuse = |error: CalibrationError| Error::calibration(&error, device, log);
    let found = channels(model, recording).map_err(refuse)?;
    let (found, touches): (Vec<Channel>, Vec<Channel>) = found.into_iter().partition(is_predicted);
    // springs and plays carry what their diagnosis took for their loads
    let loaded = with_carried_loads(model, recording);
    let with = attached(model, loaded.as_ref().unwrap_or(recording))
        .map_err(|error| Error::effect(&error, device, log))?;
    let weights = Weights::stated(model, &found);
    let residuals = channel_residuals(model, model, &with, &found, &weights).map_err(refuse)?;
    let names = touches.into_iter().map(Channel::name).collect();
    Ok((residuals, names))
}

impl Replayed {
    /// `row,channel,measured,predicted,residual` for every reading; of an orientation the residual alone, as the rotation
    /// vector from what was measured to what is predicted.
    pub fn residuals_csv(&self, log: &Log) -> String {
        let mut text = String::from("row,channel,measured,predicted,residual\n");
        for channel in &self.channels {
            for (row, values) in &channel.residuals {
                for (axis, residual) in values.iter().enumerate() {
                    let name = match values.len() {
                        1 => channel.channel.clone(),
                        _ => format!("{}.{}", channel.channel, ["x", "y", "z"][axis.min(2)]),
                    };
                    let column = channel.columns.get(axis);
                    let readings = column.and_then(|own| own.readings(&log.recording));
                    let both = readings.map_or(",".to_owned(), |readings| {
                        format!("{},{}", readings[*row], readings[*row] + residual)
                    });
                    text.push_str(&format!("{row},{name},{both},{residual}\n"));
                }
            }
        }
        text
    }

    /// Columns of the predicted log.
    pub fn shape(&self, device: &Device) -> LogShape {
        LogShape::from(&device.model)
    }
}

fn is_predicted(channel: &Channel) -> bool {
    matches!(
        channel,
        Channel::Output { .. } | Channel::Cable { .. } | Channel::Position | Channel::Orientation
    )
}

/// Leaves no reading where there is no prediction.
fn blank(recording: &mut Recording, channel: Channel, predicted: &[(usize, Vec<f64>)]) {
    let mut is_kept = vec![false; recording.len()];
    predicted.iter().for_each(|(row, _)| is_kept[*row] = true);
    for column in columns_of(channel) {
        let cells = column.readings_mut(recording).into_iter().flatten();
        let left = cells.zip(&is_kept).filter(|(_, is_kept)| !**is_kept);
        left.for_each(|(cell, _)| *cell = f64::NAN);
    }
}

/// Adds the residuals to what was measured.
fn put(recording: &mut Recording, channel: Channel, rows: &[(usize, Vec<f64>)]) {
    for (row, values) in rows {
        if channel == Channel::Orientation {
            turn(recording, *row, values);
            continue;
        }
        for (column, value) in columns_of(channel).into_iter().zip(values) {
            if let Some(column) = column.readings_mut(recording) {
                column[*row] += value;
            }
        }
    }
}

/// Turns what was measured by the residual of an orientation.
fn turn(recording: &mut Recording, row: usize, values: &[f64]) {
    if let Some(parts) = &mut recording.orientation_wxyz {
        let [w, x, y, z] = parts.each_ref().map(|part| part[row]);
        let read = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let turn = Vector3::from_column_slice(values);
        let there = (UnitQuaternion::from_scaled_axis(turn) * read).into_inner();
        for (part, value) in parts.iter_mut().zip([there.w, there.i, there.j, there.k]) {
            part[row] = value;
        }
    }
}
