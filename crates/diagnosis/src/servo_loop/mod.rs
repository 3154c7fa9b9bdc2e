//! The diagnosis of loops: how each joint of a log follows its commands (docs/diagnosis-servo.md). No position is fitted, and torques are
//! asked only for a change of their scale.

mod answer;
mod causes;
mod channel;

use haptical_effects::Effect;
use haptical_model::{Device, Recording, Statics};
use haptical_servo::{
    Finding, JointAnswer, JointLog, Predicted, Untested, diagnose_joint, torque_gain,
};

use crate::answer::Diagnosis;
use crate::{DiagnosisError, Options, Result};

/// A joint and what is said of it.
pub(crate) struct Asked {
    joint: usize,
    /// By its command.
    answer: Result<JointAnswer, Untested>,
    /// A change of its torques' scale.
    torque: Option<Finding>,
    /// What its causes make of the second recording.
    second: Option<Result<Predicted, Untested>>,
}

/// Whether any joint has commands.
pub(crate) fn has_commands(device: &Device, recording: &Recording) -> bool {
    (0..device.joints.len()).any(|joint| recording.command(joint).is_some())
}

/// Diagnoses each joint's answer to its command.
pub(crate) fn diagnose(
    device: &Device,
    recording: &Recording,
    effects: &[Box<dyn Effect>],
    options: &Options<'_>,
) -> Result<Diagnosis> {
    let second = options
        .validation
        .map(|second| Columns::new(device, second));
    let first = Columns::new(device, recording);
    let asked: Vec<Asked> = haptical_parallel::map(0..device.joints.len(), |joint| {
        let answer = first.of(joint, diagnose_joint);
        let second = (second.as_ref().zip(answer.as_ref().ok()))
            .map(|(second, answer)| second.of(joint, |log| answer.predict(log)));
        Asked {
            joint,
            answer,
            torque: first.of(joint, torque_gain),
            second,
        }
    });
    let whys = asked.iter().filter_map(|own| {
        let why = own.answer.as_ref().err()?;
        Some((why, format!("joint {}: {why}", own.joint + 1)))
    });
    let whys: Vec<(&Untested, String)> = whys.collect();
    let degrees = whys
        .iter()
        .find(|(why, _)| matches!(why, Untested::Degrees { .. }));
    if let Some((_, why)) = degrees {
        return Err(DiagnosisError::Commands { why: why.clone() });
    }
    if whys.len() == asked.len() && asked.iter().all(|own| own.torque.is_none()) {
        let is_one = whys.len() > 1 && whys.iter().all(|(why, _)| *why == whys[0].0);
        let why = match is_one {
            true => format!("joint 1 and {} more: {}", whys.len() - 1, whys[0].0),
            false => {
                let words: Vec<String> = whys.into_iter().map(|(_, words)| words).collect();
                words.join("; ")
            }
        };
        return Err(DiagnosisError::Commands { why });
    }
    Ok(answer::answer(device, recording, effects, options, asked))
}

/// The columns of a recording, joint by joint.
struct Columns<'r> {
    recording: &'r Recording,
    loads: Option<Vec<Vec<f64>>>,
}

impl<'r> Columns<'r> {
    fn new(device: &Device, recording: &'r Recording) -> Self {
        Self {
            recording,
            loads: loads(device, recording),
        }
    }

    /// What is said of a joint's columns.
    fn of<T>(&self, joint: usize, say: impl Fn(&JointLog<'_>) -> T) -> T {
        let recording = self.recording;
        let others = recording.joint.iter().enumerate();
        let others = others.filter(|(other, _)| *other != joint);
        let others: Vec<&[f64]> = others.map(|(_, column)| column.as_slice()).collect();
        say(&JointLog {
            time_s: recording.time_s.as_deref(),
            run: recording.run.as_deref(),
            command: recording.command(joint),
            response: &recording.joint[joint],
            velocity: recording.velocity(joint),
            torque: recording.torque_nm.get(joint).and_then(Option::as_deref),
            others: &others,
            load_nm: self.loads.as_ref().map(|loads| loads[joint].as_slice()),
        })
    }
}

/// Torques that gravity asks of each joint, row by row; none where the device has no masses.
fn loads(device: &Device, recording: &Recording) -> Option<Vec<Vec<f64>>> {
    if !device.has_links() {
        return None;
    }
    let mut statics = Statics::new(device);
    if !statics.has_weights() {
        return None;
    }
    let joints = device.joints.len();
    let mut loads = vec![Vec::with_capacity(recording.len()); joints];
    let mut angles = vec![0.0; joints];
    for row in 0..recording.len() {
        recording.read_joints(row, &mut angles);
        let load = statics.load(&angles, |_| None).ok()?;
        for (column, torque_nm) in loads.iter_mut().zip(load.torques_nm) {
            column.push(*torque_nm);
        }
    }
    Some(loads)
}
