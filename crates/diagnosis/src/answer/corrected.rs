//! The device with the causes that were named.

use haptical_effects::device::{entry, is_law, settle};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_effects::{Shape, Spec};
use haptical_model::{Device, DeviceEffect, JointCompliance};

use crate::DiagnosisError;
use crate::answer::{CauseAnswer, Verdict};
use crate::select::Selection;

/// The device as it was fitted together with the causes, with those of them that are part of a device; none without such.
///
/// What an event did is part of the recording: the device does not lose counts again.
///
/// # Errors
/// [`DiagnosisError`] where an effect that the device file has is none.
pub(crate) fn corrected(
    selection: &Selection<'_>,
    verdict: Verdict,
    causes: &[CauseAnswer],
) -> Result<Option<Device>, DiagnosisError> {
    if !matches!(verdict, Verdict::Named | Verdict::Ambiguous) {
        return Ok(None);
    }
    let engine = selection.engine();
    let mut device = engine.problem.device_with(&selection.refit.model.values);
    let mut has_any = false;
    // effects that the device had before were fitted with it
    settle(&mut device, engine.context.recording, &|_| None)?;
    for cause in selection.causes() {
        let effect = selection.effect(cause);
        let number = effect.joint().map(|joint| joint + 1);
        let is_own =
            |answer: &&CauseAnswer| answer.effect == effect.name() && answer.joint == number;
        let Some(answer) = causes.iter().find(is_own) else {
            continue;
        };
        if !is_of_device(effect.spec()) {
            continue;
        }
        has_any = true;
        let found = entry(effect, &engine.context, &cause.amplitudes, cause.shape);
        let found = DeviceEffect {
            intervals: intervals(answer),
            confusable_with: answer.confusable_with.clone(),
            fit: true,
            ..found
        };
        match effect.joint() {
            Some(joint) if effect.name() == JOINT_COMPLIANCE.name => {
                let joints = device.joints.len();
                let compliance = &mut device.surroundings.compliance;
                compliance.resize(joints, JointCompliance::default());
                compliance[joint] = JointCompliance {
                    rad_per_nm: cause.amplitudes[0],
                    fit: true,
                };
            }
            _ => device.effects.push(found),
        }
    }
    let drives = drive_effects(causes);
    has_any |= !drives.is_empty();
    device.effects.extend(drives);
    Ok(has_any.then_some(device))
}

/// The device with the causes that its drives' torques show; none without such.
pub(crate) fn of_drives(
    device: &Device,
    verdict: Verdict,
    causes: &[CauseAnswer],
) -> Option<Device> {
    let effects = match verdict {
        Verdict::Named | Verdict::Ambiguous => drive_effects(causes),
        Verdict::NoGap | Verdict::Unknown => Vec::new(),
    };
    let mut device = device.clone();
    device.effects.extend(effects);
    (!device.effects.is_empty()).then_some(device)
}

/// Effects on torques, whose reported parameters are all that their laws have.
fn drive_effects(causes: &[CauseAnswer]) -> Vec<DeviceEffect> {
    let of_cause = |cause: &CauseAnswer| {
        let is_whole = |spec: &&Spec| {
            let mut parameters = spec.parameters.iter();
            spec.name == cause.effect
                && spec.hook.is_on_drives()
                && is_law(spec).is_ok()
                && spec.further.is_empty()
                && parameters.all(|own| cause.parameters.contains_key(own.name))
        };
        haptical_effects::specs().find(is_whole)?;
        let numbers = cause.parameters.iter();
        Some(DeviceEffect {
            name: cause.effect.clone(),
            joint: cause.joint.map(|joint| joint - 1),
            numbers: numbers
                .map(|(name, answer)| (name.clone(), answer.value))
                .collect(),
            intervals: intervals(cause),
            confusable_with: cause.confusable_with.clone(),
            fit: true,
            ..DeviceEffect::default()
        })
    };
    causes.iter().filter_map(of_cause).collect()
}

/// Whether an effect is part of a device, so that it is there in the next recording too.
fn is_of_device(spec: &Spec) -> bool {
    is_law(spec).is_ok() && spec.shape != Shape::Event
}

fn intervals(answer: &CauseAnswer) -> std::collections::BTreeMap<String, [Option<f64>; 2]> {
    let parameters = answer.parameters.iter();
    parameters
        .map(|(name, parameter)| (name.clone(), parameter.ci95.map(Some)))
        .collect()
}
