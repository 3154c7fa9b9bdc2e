//! Friction, armatures and offsets of a moving arm's drives in corrected.toml.

use haptical_diagnosis::{BESIDE_TORQUES, Diagnosis};
use haptical_model::Device as Model;
use haptical_motion::{identify_drives, torques_left, with_dynamics};

use super::corrected::{tell_left, text};
use crate::device::Device;
use crate::files::DIAGNOSIS_FILES;
use crate::identify::{without_effects, without_friction};
use crate::log::Log;
use crate::reproduced::Left;

/// What the file does not hold of them: beside a law of friction that is not quite the drive's a delay is no delay of the log.
const DELAY: &str =
    "the delay of the drives' torques: `haptical identify --with dynamics` finds it";

/// Puts what the log shows of the drives into the device with the causes of a moving arm. Where the file, read again, does not leave of
/// each torque what the fit of the drives leaves, the device stays as it is, and a warning says why.
pub(super) fn fill(device: &Device, log: &Log, diagnosis: &mut Diagnosis) {
    let is_beside = |words: &String| words == BESIDE_TORQUES;
    let Some(bare) = diagnosis.corrected.clone() else {
        return;
    };
    if !diagnosis.not_in_file.iter().any(is_beside) {
        return;
    }
    match filled(device, &bare, log, diagnosis) {
        Ok(left) => {
            let words = diagnosis.not_in_file.iter_mut();
            let beside = words.filter(|words| is_beside(words));
            beside.for_each(|words| *words = DELAY.to_owned());
            tell_left(diagnosis, left);
        }
        Err(why) => {
            diagnosis.corrected = Some(bare);
            let file = DIAGNOSIS_FILES[3];
            let warning = format!("{file} lacks friction and offsets of the drives: {why}");
            diagnosis.warnings.push(warning);
        }
    }
}

/// What the file leaves of each torque, once the answer has the device with the drives.
fn filled(
    device: &Device,
    bare: &Model,
    log: &Log,
    diagnosis: &mut Diagnosis,
) -> Result<Vec<(String, f64)>, String> {
    let place = (device.source().path.as_path(), log.source().path.as_path());
    let recording = without_effects(bare, &log.recording, place);
    let recording = recording.map_err(|error| error.to_string())?;
    let found = identify_drives(bare, &recording).map_err(|error| error.to_string())?;
    let mut model = with_dynamics(bare, &found).map_err(|error| error.to_string())?;
    for (own, given) in model.joints.iter_mut().zip(&bare.joints) {
        own.torque_delay_s = given.torque_delay_s;
    }
    // a friction that is a cause is the one of its joint
    let causes = bare.effects.iter().filter(|own| own.is_friction());
    for cause in causes {
        let is_same = |joint| joint == cause.joint;
        (model.effects).retain(|own| !own.is_friction() || !is_same(own.joint));
        model.effects.push(cause.clone());
    }
    diagnosis.corrected = Some(model);
    let written = text(device, diagnosis).map_err(|error| error.to_string())?;
    let read = Device::from_toml(&written.unwrap_or_default(), DIAGNOSIS_FILES[3])
        .map_err(|error| format!("it would not be read again: {error}"))?;
    let torques = without_effects(&without_friction(&read.model), &log.recording, place);
    let torques = torques.map_err(|error| error.to_string())?;
    let left = torques_left(&read.model, &torques, found.edge_hz);
    let mut all = Vec::new();
    for (joint, rms) in left.map_err(|error| error.to_string())? {
        let channel = format!("torque{}", joint + 1);
        let fit = found.residuals.iter().find(|own| own.joint == joint);
        let fit = fit.ok_or_else(|| format!("{channel} was not fitted"))?;
        let own = Left {
            channel,
            unit: String::new(),
            rms: fit.after_rms,
            held_out: None,
            noise_floor: 0.0,
        };
        if own.is_missed_by(rms) {
            let (channel, fit) = (own.channel, own.rms);
            return Err(format!("{channel} leaves {rms:.4} in place of {fit:.4}"));
        }
        all.push((own.channel, rms));
    }
    Ok(all)
}
