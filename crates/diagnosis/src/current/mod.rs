//! The diagnosis of motors: whether each joint's torque follows its motor's current (docs/equations.md, Between current and torque).

mod answer;
mod choose;
mod rows;

use haptical_effects::force::{MAGNETIC_SATURATION, TORQUE_CONSTANT_DRIFT};
use haptical_model::{Device, Recording};

use self::answer::{Joint, answer};
pub(crate) use self::rows::without_currents;
use self::rows::{Rows, read};
use crate::answer::Diagnosis;
use crate::{DiagnosisError, Options, Result};

/// Effects that this view alone tests.
pub(crate) const NAMES: [&str; 2] = [MAGNETIC_SATURATION.name, TORQUE_CONSTANT_DRIFT.name];

/// Diagnoses each joint's torque by its current.
pub(crate) fn diagnose(
    device: &Device,
    recording: &Recording,
    options: &Options<'_>,
) -> Result<Diagnosis> {
    let with = (0..device.joints.len()).filter(|joint| recording.current(*joint).is_some());
    let asked = haptical_parallel::map(with, |joint| {
        let place = (joint, device.joints[joint].joint_type);
        let rows = read(recording, place).and_then(|own| Rows::new(own, &options.without));
        rows.map(|rows| Joint::new(joint, rows))
            .map_err(|why| format!("joint {}: its current was not tested: {why}", joint + 1))
    });
    let (mut joints, mut untested) = (Vec::new(), Vec::new());
    for own in asked {
        match own {
            Ok(joint) => joints.push(joint),
            Err(why) => untested.push(why),
        }
    }
    if joints.is_empty() {
        let why = untested.join("; ");
        return Err(DiagnosisError::Currents { why });
    }
    Ok(answer((device, recording, options), joints, untested))
}
