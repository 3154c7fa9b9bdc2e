//! Makes recordings of a device whose every number is known.

use haptical_model::{Device, Evaluation, Joint, Recording, TransmissionKind};

use crate::SimulatorError;
use crate::poses::PoseSampler;
use crate::sampling::JointSampler;
use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::streams::{Stream, seek_row};

/// Line of a log of the first row; line 1 is the header.
pub(crate) const FIRST_LINE: u64 = 2;

/// Simulates a recording of random poses of a device.
///
/// For each row, readings theta are drawn first: motor angles over the nominal ratios, from home, as
/// [`Settings::sampling`] says. The joints of `truth` move by theta + error(theta), and its links
/// place the handle. The columns are
///
/// | column | value | Gaussian sd | count |
/// |---|---|---|---|
/// | `joint` | theta | none | 2 pi / `encoder_counts_per_rev` / \|`transmission_ratio`\|, if [`Settings::motor_counts`] |
/// | `output` | theta + error(theta) | `external_encoder_sd_rad`, else 2 pi / `external_encoder_counts_per_rev` / 3 | 2 pi / `external_encoder_counts_per_rev` |
/// | `cable_m` | distance between anchor and handle | [`Settings::cable_sigma`] | 2 pi `drum_radius_m` / `counts_per_rev` |
///
/// in rad, or m for prismatic joints and cables; noise as [`Settings::output_noise`] and
/// [`Settings::cable_noise`] say. Joints whose transmission is direct and that have no external
/// encoder have no `output`; a device without links has no `cable_m`. There is no time column, and
/// lines count from 2.
///
/// Row k depends on device, settings, seed and k, not on `rows`; each noise has random numbers of
/// its own (see the crate's documentation).
///
/// Source: Baser & Konukseven eq. (1), (4), (5); docs/equations.md, Noise.
///
/// # Errors
/// [`SimulatorError`]: settings or numbers of the device out of range, a number of the device that a
/// noise needs and that is missing, no room for poses, a true device that has no value somewhere.
///
/// # Examples
/// ```
/// use haptical_simulator::model::Device;
/// use haptical_simulator::{Settings, simulate};
/// let text = "[[joint]]\nsampling_sd_rad = 0.3\nexternal_encoder_sd_rad = 1e-4\n";
/// let truth = Device::from_toml(text, "one.toml")?.device;
/// let recording = simulate(&truth, &Settings::paper(), 5, 1)?;
/// let output = recording.output[0].as_ref().expect("the joint has an external encoder");
/// for (reading, output) in recording.joint[0].iter().zip(output) {
///     assert!(reading.abs() <= 0.9 && (output - reading).abs() < 1e-3);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(
    truth: &Device,
    settings: &Settings,
    rows: usize,
    seed: u64,
) -> Result<Recording, SimulatorError> {
    settings.check(rows)?;
    let mut poses = PoseSampler::new(truth, settings, seed)?;
    let motors = truth.joints.iter().enumerate();
    let motors = motors.map(|(index, joint)| Sensor::motor(joint, index, settings));
    let mut motors: Vec<_> = motors.collect::<Result<_, SimulatorError>>()?;
    let output = |(index, joint): (usize, &Joint)| {
        let generator = Stream::Output.open(index, seed);
        let sensor = || Sensor::output(joint, index, settings.output_noise, generator);
        has_output(joint).then(sensor).transpose()
    };
    let outputs = truth.joints.iter().enumerate().map(output);
    let mut outputs: Vec<_> = outputs.collect::<Result<_, SimulatorError>>()?;
    let measured = if truth.has_links() {
        &truth.cables[..]
    } else {
        &[]
    };
    let cables = measured.iter().enumerate().map(|(index, cable)| {
        Sensor::cable(cable, index, settings, Stream::Cable.open(index, seed))
    });
    let mut cables: Vec<_> = cables.collect::<Result<_, SimulatorError>>()?;

    let mut recording = empty_recording(truth);
    for row in 0..rows {
        poses.move_to_row(row)?;
        recording.line.push(FIRST_LINE + row as u64);
        for (joint, motor) in motors.iter_mut().enumerate() {
            let shown = motor.read(poses.readings[joint]);
            recording.joint[joint].push(finite(shown, row, "theta", joint)?);
        }
        for (joint, sensor) in outputs.iter_mut().enumerate() {
            if let Some(sensor) = sensor {
                let shown = sensor.read(poses.evaluation.output_rad(joint));
                let column = recording.output[joint].get_or_insert_default();
                column.push(finite(shown, row, "out", joint)?);
            }
        }
        for (cable, sensor) in cables.iter_mut().enumerate() {
            let shown = sensor.read(poses.distances_m[cable]);
            let column = recording.cable_m[cable].get_or_insert_default();
            column.push(finite(shown, row, "cable ", cable)?);
        }
    }
    Ok(recording)
}

/// Simulates a recording of one transmission: only `joint` (from 0) moves, all others stay at a
/// reading of zero, and only its external encoder is recorded.
///
/// Readings, noise and counts are as in [`simulate`], with random numbers that neither [`simulate`]
/// nor another joint uses, so that one seed may serve all recordings of a device. Units: rad, or m
/// for a prismatic joint. Source: Baser & Konukseven eq. (1), and the first step of their Figure 6.
///
/// # Errors
/// As [`simulate`], and [`SimulatorError::NoJoint`].
pub fn simulate_transmission(
    truth: &Device,
    settings: &Settings,
    joint: usize,
    rows: usize,
    seed: u64,
) -> Result<Recording, SimulatorError> {
    settings.check(rows)?;
    let Some(moving) = truth.joints.get(joint) else {
        return Err(SimulatorError::NoJoint {
            joint,
            joints: truth.joints.len(),
        });
    };
    let sampler = JointSampler::new(moving, joint, settings)?;
    let mut motor = Sensor::motor(moving, joint, settings)?;
    let noise_generator = Stream::TransmissionOutput.open(joint, seed);
    let mut sensor = Sensor::output(moving, joint, settings.output_noise, noise_generator)?;
    let mut generator = Stream::TransmissionPoses.open(joint, seed);
    let mut evaluation = Evaluation::new(truth);

    let mut recording = empty_recording(truth);
    for (index, column) in recording.joint.iter_mut().enumerate() {
        if index != joint {
            column.resize(rows, 0.0);
        }
    }
    let mut outputs = Vec::new();
    for row in 0..rows {
        seek_row(&mut generator, row);
        let reading = sampler.draw(&mut generator)?;
        evaluation
            .move_joint(joint, reading)
            .map_err(|source| SimulatorError::Row { row, source })?;
        recording.line.push(FIRST_LINE + row as u64);
        recording.joint[joint].push(finite(motor.read(reading), row, "theta", joint)?);
        let output = sensor.read(evaluation.output_rad(joint));
        outputs.push(finite(output, row, "out", joint)?);
    }
    recording.output[joint] = Some(outputs);
    Ok(recording)
}

/// Whether a log has an `out` column for the joint.
pub(crate) fn has_output(joint: &Joint) -> bool {
    joint.transmission != TransmissionKind::Direct
        || joint.external_encoder_sd_rad.is_some()
        || joint.external_encoder_counts_per_rev.is_some()
}

/// A recording without rows, its columns counted as a reader of logs counts them.
fn empty_recording(truth: &Device) -> Recording {
    let joints = truth.joints.len();
    Recording {
        joint: vec![Vec::new(); joints],
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        cable_m: vec![None; truth.cables.len()],
        ..Recording::default()
    }
}

/// Passes on a finite reading of the channel with a name and an index, from 0.
pub(crate) fn finite(
    value: f64,
    row: usize,
    name: &str,
    index: usize,
) -> Result<f64, SimulatorError> {
    if value.is_finite() {
        return Ok(value);
    }
    let channel = format!("{name}{}", index + 1);
    Err(SimulatorError::NonFinite {
        row,
        channel,
        value,
    })
}
