//! The variance that the steps of the motor-side encoders add to a channel's residuals.

use std::ops::Range;

use haptical_batch::PoseBatch;
use haptical_model::kinematics::Parameter;
use haptical_model::{Device, Evaluation, JointType, Mount, Recording};

use crate::error::at_row;
use crate::problem::channel::with_kind;
use crate::problem::lanes::cable::cable_model;
use crate::problem::lanes::transmission::values_and_slopes;
use crate::problem::loads::Loads;
use crate::problem::measurement::kind::{Measurement, Posture};
use crate::problem::measurement::tracked::Mountings;
use crate::problem::mounts::mounts;
use crate::problem::tiles::variances::variances;
use crate::{CalibrationError, Channel};

/// Rows that one thread works out at a time.
const ROWS_AT_ONCE: usize = 1024;

/// Variance that the rounding of the readings adds to a channel's residual at each row of the recording:
/// sum_i (d residual / d reading_i)^2 q_i^2 / 12, q_i the step of joint i's reading (docs/equations.md,
/// "Propagated quantization"). For positions and orientations the mean over the three axes.
///
/// Encoders and cables of a plain chain are worked out in lanes, what else moves with the handle in tiles, everything
/// else, and whatever these refuse, row by row. `loads` are those of the recording where joints yield.
pub(crate) fn propagated_variances(
    device: &Device,
    recording: &Recording,
    channel: Channel,
    loads: Option<&Loads>,
) -> Result<Vec<f64>, CalibrationError> {
    let quanta = quantum_variances(device);
    // nothing is rounded: only a reading that is refused would be news
    let is_sound = |column: &Vec<f64>| column.iter().all(|reading| reading.is_finite());
    if quanta.iter().all(|quantum| *quantum == 0.0) && recording.joint.iter().all(is_sound) {
        return Ok(vec![0.0; recording.len()]);
    }
    let mounts = mounts(device, recording, &[channel])?;
    let around = (loads, mounts.as_slice());
    let starts = (0..recording.len()).step_by(ROWS_AT_ONCE);
    let parts: Vec<Result<Vec<f64>, CalibrationError>> = haptical_parallel::map(starts, |start| {
        let rows = start..(start + ROWS_AT_ONCE).min(recording.len());
        // a chain that yields is no plain chain
        let lanes = match &loads {
            None => in_lanes(device, recording, channel, rows.clone()),
            Some(_) => None,
        };
        let whole = (device, recording, channel);
        let tiles = || variances(whole, around, &quanta, &rows);
        lanes
            .or_else(tiles)
            .map_or_else(|| by_row(whole, around, rows), Ok)
    });
    let mut variances = Vec::with_capacity(recording.len());
    // the first refused row is reported, whichever thread met it first
    for part in parts {
        variances.extend(part?);
    }
    Ok(variances)
}

/// q_i^2 / 12 of every joint.
fn quantum_variances(device: &Device) -> Vec<f64> {
    let of = |step: f64| step * step / 12.0;
    let joints = device.joints.iter();
    joints
        .map(|joint| joint.reading_quantum_rad().map_or(0.0, of))
        .collect()
}

fn in_lanes(
    device: &Device,
    recording: &Recording,
    channel: Channel,
    rows: Range<usize>,
) -> Option<Vec<f64>> {
    let readings = |joint: usize| recording.joint.get(joint)?.get(rows.clone());
    let quanta = quantum_variances(device);
    let index = match channel {
        Channel::Output { joint } => {
            let (_, slopes) = values_and_slopes(device, joint, readings(joint)?)?;
            let quantum = quanta[joint];
            let square = |slope: f64| slope * slope * quantum;
            return Some(slopes.into_iter().map(square).collect());
        }
        Channel::Cable { index } => index,
        _ => return None,
    };
    let mut angles = Vec::with_capacity(device.joints.len());
    // what each joint moves; a turn is taken into the angle, so that its own sines serve as they are
    let (mut moved, mut values) = (Vec::new(), Vec::new());
    // joints whose readings come in steps: place among these, and variance over that of the row's variable
    let (mut stepped, mut factors) = (Vec::new(), Vec::new());
    for (joint, (described, quantum)) in device.joints.iter().zip(quanta).enumerate() {
        let own = readings(joint)?;
        let (errors, slopes) = values_and_slopes(device, joint, own)?;
        let link = device.links.get(joint + 1)?;
        let (parameter, turned_rad, value) = match described.joint_type {
            JointType::Revolute => (Parameter::Theta, link.theta_rad, 0.0),
            JointType::Prismatic => (Parameter::D, 0.0, link.d_m),
        };
        moved.push((joint + 1, parameter));
        values.push(value);
        let outputs = own.iter().zip(errors);
        let angle =
            outputs.map(|(reading, error)| reading + error + described.home_rad + turned_rad);
        angles.push(angle.collect::<Vec<f64>>());
        if quantum != 0.0 {
            let square = |slope: f64| slope * slope * quantum;
            stepped.push(joint);
            factors.push(slopes.into_iter().map(square).collect::<Vec<f64>>());
        }
    }
    let model = cable_model(device, index, &moved)?;
    let (distances_m, weights) = (vec![0.0; rows.len()], vec![1.0; rows.len()]);
    let poses = PoseBatch::new(model.motions(), &angles, &distances_m, &weights).ok()?;
    let mut variances = vec![0.0; rows.len()];
    let visited = poses.visit(&model, &values, &stepped, |tile| {
        let own = tile.first_pose()..tile.first_pose() + tile.residuals().len();
        for (derivatives, factors) in tile.derivatives().zip(&factors) {
            let into = variances[own.clone()].iter_mut();
            for (variance, (along, factor)) in
                into.zip(derivatives.iter().zip(&factors[own.clone()]))
            {
                *variance += along * along * factor;
            }
        }
    });
    visited.ok()?;
    let is_sound = variances.iter().all(|variance| variance.is_finite());
    is_sound.then_some(variances)
}

fn by_row(
    (device, recording, channel): (&Device, &Recording, Channel),
    (loads, mounts): (Option<&Loads>, &[Mount]),
    rows: Range<usize>,
) -> Result<Vec<f64>, CalibrationError> {
    let quanta = quantum_variances(device);
    let is_touch = |row| channel.subject(device, recording, row).is_some();
    let mountings = Mountings::new(device, mounts.get(rows.clone()).unwrap_or(&[]));
    let mut evaluation = Evaluation::new(device);
    let mut readings = vec![0.0; device.joints.len()];
    let mut variances = Vec::with_capacity(rows.len());
    for row in rows {
        recording.read_joints(row, &mut readings);
        evaluation.choose_hand(device.hand_at(recording, row));
        let refused = at_row(recording, row);
        if let Channel::Output { joint } = channel {
            let moved = evaluation.move_joint(joint, readings[joint]);
            moved.map_err(&refused)?;
            variances.push(evaluation.output_slope(joint).powi(2) * quanta[joint]);
            continue;
        }
        // a touch has no place where nothing is touched
        if is_touch(row) && !channel.has_reading(recording, row) {
            variances.push(0.0);
            continue;
        }
        if let Some(loads) = loads {
            evaluation.set_torques(loads.of_row(row));
        }
        evaluation.move_to(&readings).map_err(&refused)?;
        if let Channel::Fixture { joint } = channel {
            variances.push(evaluation.output_slope(joint).powi(2) * quanta[joint]);
            continue;
        }
        let at = Posture {
            device,
            evaluation: &evaluation,
            recording,
            row,
            subject: channel
                .subject(device, recording, row)
                .and_then(Result::ok)
                .unwrap_or(usize::MAX),
            mount: mounts.get(row).copied().unwrap_or_default(),
            mountings: &mountings,
        };
        let mut sum = 0.0;
        for (joint, quantum) in quanta.iter().enumerate() {
            let twist = evaluation.reading_twist(joint);
            let square = with_kind!(channel, kind => kind.sensitivity_square(&at, &twist));
            sum += quantum * square.map_err(&refused)?;
        }
        variances.push(sum);
    }
    Ok(variances)
}

#[cfg(test)]
mod tests {
    use haptical_model::transmission::CapstanError;
    use haptical_model::{Placement, TransmissionError};

    use super::*;

    /// Relative to the variance: rounding of two sweeps along seven joints.
    const TOLERANCE: f64 = 1e-12;

    fn device_and_recording(rows: usize) -> Option<(Device, Recording)> {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/devices/haptic7.toml"
        );
        let Ok(loaded) = Device::load(path.as_ref()) else {
            println!("skipped: no {path}");
            return None;
        };
        let mut device = loaded.device;
        let capstan = CapstanError::from_polar(1e-3, 0.07, 4e-4, 0.7, 2e-5, -2.0);
        device.joints[0].transmission_error = TransmissionError::Capstan(capstan);
        device.joints[1].transmission_error = TransmissionError::Chebyshev {
            range_rad: [-0.4, 0.3],
            coefficients: vec![0.004, -0.011, 0.006, 0.002],
        };
        device.joints[3].transmission_error = TransmissionError::Parallelogram {
            capstan,
            length_deviations_m: [5e-4, -7e-4, 0.0, 0.0],
        };
        let reading = |joint: usize, row: usize| 0.6 * (0.7 * row as f64 + joint as f64).sin();
        let recording = Recording {
            line: (2..rows as u64 + 2).collect(),
            joint: (0..7)
                .map(|joint| (0..rows).map(|row| reading(joint, row)).collect())
                .collect(),
            ..Recording::default()
        };
        Some((device, recording))
    }

    #[test]
    fn lanes_and_rows_agree() {
        let Some((device, recording)) = device_and_recording(2500) else {
            return;
        };
        let outputs = (0..7).map(|joint| Channel::Output { joint });
        for channel in outputs.chain([Channel::Cable { index: 0 }]) {
            let all = 0..recording.len();
            let lanes = in_lanes(&device, &recording, channel, all.clone()).unwrap();
            let rows = by_row((&device, &recording, channel), (None, &[]), all).unwrap();
            assert_eq!((lanes.len(), rows.len()), (2500, 2500));
            for (a, b) in lanes.iter().zip(&rows) {
                assert!(
                    (a - b).abs() <= TOLERANCE * b,
                    "{channel:?}: {a:e} for {b:e}"
                );
            }
            let parts = propagated_variances(&device, &recording, channel, None).unwrap();
            for (a, b) in parts.iter().zip(&rows) {
                assert!(
                    (a - b).abs() <= TOLERANCE * b,
                    "{channel:?}: {a:e} for {b:e}"
                );
            }
        }
        // only joints with an encoder count
        let cable = Channel::Cable { index: 0 };
        let found = propagated_variances(&device, &recording, cable, None).unwrap();
        assert!(found.iter().all(|variance| *variance > 0.0));
    }

    /// What moves with the handle, and a touch that only every third row has.
    #[test]
    fn tiles_and_rows_agree() {
        let Some((mut device, mut recording)) = device_and_recording(150) else {
            return;
        };
        device.links[3].beta_rad = 0.02;
        device.surroundings.tracker_tool = Some(Placement {
            turn_rad: [0.3, -0.2, 0.1],
            ..Placement::default()
        });
        recording.position_m = Some([(); 3].map(|()| vec![0.1; 150]));
        recording.orientation_wxyz = Some([1.0, 0.1, 0.2, 0.3].map(|part| vec![part; 150]));
        let touched = |row: usize| if row.is_multiple_of(3) { "socket" } else { "" };
        recording.contact = Some((0..150).map(|row| touched(row).to_owned()).collect());
        let quanta = quantum_variances(&device);
        for channel in [Channel::Position, Channel::Orientation, Channel::Contact] {
            let whole = (&device, &recording, channel);
            let tiles = variances(whole, (None, &[]), &quanta, &(0..150)).unwrap();
            let rows = by_row(whole, (None, &[]), 0..150).unwrap();
            assert!(rows[0] > 0.0 && rows.len() == 150);
            for (a, b) in tiles.iter().zip(&rows) {
                assert!(
                    (a - b).abs() <= TOLERANCE * b,
                    "{channel:?}: {a:e} for {b:e}"
                );
            }
        }
    }

    #[test]
    fn the_first_row_that_is_refused_is_named() {
        let Some((device, mut recording)) = device_and_recording(5000) else {
            return;
        };
        for row in [4500, 1900, 2100] {
            recording.joint[5][row] = f64::NAN;
            recording.joint[1][row] = f64::INFINITY;
        }
        for channel in [Channel::Cable { index: 0 }, Channel::Output { joint: 1 }] {
            let error = propagated_variances(&device, &recording, channel, None).unwrap_err();
            assert!(
                matches!(error, CalibrationError::Row { line: 1902, .. }),
                "{error}"
            );
        }
    }
}
