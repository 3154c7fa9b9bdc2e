//! Readings of a device with effects, from those of the same device without them.

use haptical_calibration::{Channel, channels};
use haptical_model::kinematics::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use haptical_model::{AddedBy, AddedReadings, Device, DeviceEffect, Recording};

use crate::device::bare::bare;
use crate::device::error::DeviceEffectError;
use crate::device::resolve::effects_of;
use crate::structure::JOINT_COMPLIANCE;
use crate::{Context, Signal, Stream, streams};

/// Adds what the effects of a device and the compliances of its joints do to the readings of a recording that was made
/// without them: external encoders, cables, positions, orientations, torques.
///
/// Each effect acts alone on the recorded motion: what two of them do together beyond the sum is left out.
///
/// # Errors
/// [`DeviceEffectError`].
pub fn add_effects(device: &Device, recording: &mut Recording) -> Result<(), DeviceEffectError> {
    let Some((streams, sum)) = sum_of_effects(device, recording)? else {
        return Ok(());
    };
    let joints = device.joints.len();
    let mut turns: Vec<Vector3<f64>> = Vec::new();
    for (stream, values) in &sum.parts {
        match streams.get(*stream) {
            Some(stream) => add_to(stream, values, recording, &mut turns),
            None => {
                let joint = stream - streams.len();
                let column = recording
                    .torque_nm
                    .get_mut(joint)
                    .filter(|_| joint < joints);
                add(column.and_then(Option::as_mut), values);
            }
        }
    }
    turn(recording, &turns);
    Ok(())
}

/// What the effects of a device and the compliances of its joints show in the channels of a recording, touches and
/// fixtures among them; all of them together, an entry for each axis. Empty for a device without effects.
///
/// # Errors
/// [`DeviceEffectError`].
pub fn shown_by_effects(
    device: &Device,
    recording: &Recording,
) -> Result<Vec<AddedReadings>, DeviceEffectError> {
    let Some((streams, sum)) = sum_of_effects(device, recording)? else {
        return Ok(Vec::new());
    };
    let shown = sum.parts.into_iter().filter_map(|(stream, readings)| {
        let stream = streams.get(stream)?;
        Some(AddedReadings {
            effect: 0,
            channel: stream.channel.name(),
            axis: stream.axis,
            by: AddedBy::default(),
            readings,
            at: Vec::new(),
            slopes: Vec::new(),
        })
    });
    Ok(shown.collect())
}

/// The streams of a recording, and what all effects of a device together show in them; none for a device without effects.
fn sum_of_effects(
    device: &Device,
    recording: &Recording,
) -> Result<Option<(Vec<Stream>, Signal)>, DeviceEffectError> {
    let mut whole = device.clone();
    for (joint, own) in device.surroundings.compliance.iter().enumerate() {
        if own.rad_per_nm != 0.0 {
            whole.effects.push(DeviceEffect {
                name: JOINT_COMPLIANCE.name.to_owned(),
                joint: Some(joint),
                numbers: [(
                    JOINT_COMPLIANCE.parameters[0].name.to_owned(),
                    1.0 / own.rad_per_nm,
                )]
                .into(),
                ..DeviceEffect::default()
            });
        }
    }
    let own = effects_of(&whole)?;
    if own.is_empty() {
        return Ok(None);
    }
    let base = bare(device);
    let channels = channels(&base, recording).unwrap_or_default();
    let streams = streams(&base, &channels);
    let mut sum = Signal::default();
    {
        let mut context = Context::new(&base, recording, &streams)?;
        let mean_degc = context.reference_degc;
        for effect in &own {
            let label = effect.effect.label();
            if effect.values.is_none() {
                let key = effect.effect.spec().parameters[0].name;
                let known = key.to_owned();
                return Err(DeviceEffectError::Missing { label, key, known });
            }
            if let Some(why) = effect.effect.untestable(&context)
                && effect.effect.lacks_covariate(&context)
            {
                return Err(DeviceEffectError::Untestable { label, why });
            }
            context.set_reference_degc(effect.reference_degc().unwrap_or(mean_degc));
            let (amplitudes, shape) = effect.amplitudes(&context);
            let signal = effect.effect.exact_signal(&context, &amplitudes, shape);
            sum.add(&signal, 1.0);
        }
    }
    Ok(Some((streams, sum)))
}

fn add(column: Option<&mut Vec<f64>>, values: &[f64]) {
    for (entry, value) in column.into_iter().flatten().zip(values) {
        *entry += value;
    }
}

/// Adds to one axis of a channel; rotations are collected.
fn add_to(
    stream: &Stream,
    values: &[f64],
    recording: &mut Recording,
    turns: &mut Vec<Vector3<f64>>,
) {
    match stream.channel {
        Channel::Output { joint } => {
            add(
                recording.output.get_mut(joint).and_then(Option::as_mut),
                values,
            );
        }
        Channel::Cable { index } => {
            add(
                recording.cable_m.get_mut(index).and_then(Option::as_mut),
                values,
            );
        }
        Channel::Position => {
            let axes = recording.position_m.as_mut();
            add(axes.map(|axes| &mut axes[stream.axis]), values);
        }
        Channel::Orientation => {
            turns.resize(values.len(), Vector3::zeros());
            for (turn, value) in turns.iter_mut().zip(values) {
                turn[stream.axis] += value;
            }
        }
        // what is touched stays where it is: the joints read otherwise (`shown_by_effects`)
        _ => {}
    }
}

/// Turns the orientations by rotation vectors in the tracker's frame.
fn turn(recording: &mut Recording, turns: &[Vector3<f64>]) {
    let Some(parts) = &mut recording.orientation_wxyz else {
        return;
    };
    for (row, turn) in turns.iter().enumerate() {
        let [w, x, y, z] = parts.each_ref().map(|part| part[row]);
        let before = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let after = (UnitQuaternion::from_scaled_axis(*turn) * before).into_inner();
        let after = [after.w, after.i, after.j, after.k];
        for (part, value) in parts.iter_mut().zip(after) {
            part[row] = value;
        }
    }
}
