//! Effects on torques that are asked for, fitted where geometry and drives are known.

use haptical_diagnosis::{AskedOfTorques, DiagnosisError, ask_torques};
use haptical_model::{Device as Model, DeviceEffect, Recording};

use super::{EffectEntry, SHOWN, numbers, why};

/// Fits effects to the torques of an identified device, which gets those that the log shows, and keeps those that it had where
/// nothing can be said of them. Torques say nothing of geometry and drives that other channels do not say better: what they
/// allow for is its tolerance.
pub(super) fn fit(
    device: &mut Model,
    recording: &Recording,
    asked: &[DeviceEffect],
) -> Result<Vec<EffectEntry>, DiagnosisError> {
    if asked.is_empty() {
        return Ok(Vec::new());
    }
    let mut whole = device.clone();
    let first = whole.effects.len();
    whole.effects.extend(asked.iter().cloned());
    let indices: Vec<usize> = (first..whole.effects.len()).collect();
    let answers = ask_torques(&whole, recording, &indices)?;
    let mut entries = Vec::new();
    for (before, answer) in asked.iter().zip(answers) {
        let entry = entry(before, &answer);
        let found = answer.effect.filter(|_| entry.shown);
        let had = Some(before.clone()).filter(|own| !own.numbers.is_empty());
        device.effects.extend(found.or(had));
        entries.push(entry);
    }
    Ok(entries)
}

fn entry(asked: &DeviceEffect, answer: &AskedOfTorques) -> EffectEntry {
    // noise closes as often more of an unseen gap as less
    let held_out = answer.held_out.as_ref();
    let closed_percent = held_out.and_then(|own| own.reduction_percent);
    let is_by_chance = answer.p_value.is_none_or(|p| p >= SHOWN);
    let shown = !is_by_chance && closed_percent.is_none_or(|percent| percent > 0.0);
    EffectEntry {
        effect: asked.name.clone(),
        joint: asked.joint.map(|joint| joint + 1),
        parameters: answer.effect.as_ref().map(numbers).unwrap_or_default(),
        p_value: answer.p_value,
        shown,
        why: match &answer.why_not {
            Some(why_not) => why_not.clone(),
            None => why(answer.p_value, !is_by_chance) + &unseen(answer, shown, is_by_chance),
        },
    }
}

/// What it closes on rows that the fit did not see, as the end of a sentence.
fn unseen(answer: &AskedOfTorques, shown: bool, is_by_chance: bool) -> String {
    let Some(own) = &answer.held_out else {
        return "; the log is too short to try it on unseen rows".to_owned();
    };
    let (before, after) = (own.rms_before, own.rms_after);
    let worse = match shown || is_by_chance {
        true => "",
        false => ", which is no better: it is left out",
    };
    format!(
        "; on the last third of the log, unseen, {} is off by {after:.2e} {} in place of {before:.2e}{worse}",
        own.channel, own.unit
    )
}
