//! Refusals of the effects of a device.

use std::path::Path;

use haptical_effects::device::{DeviceEffectError, effects_of};
use haptical_model::Device as Model;

use super::{Error, LEAVE_ROW_OUT};

impl Error {
    /// A refused effect of a device, or one that a log does not drive.
    pub(crate) fn effect(error: &DeviceEffectError, device: &Path, log: &Path) -> Self {
        let text = error.to_string();
        match error {
            DeviceEffectError::Untestable { .. } => {
                let next = "record what drives it, or take it out of the device file";
                Self::in_file("effect", text, log, next)
            }
            DeviceEffectError::Context(_) => Self::in_file("row", text, log, LEAVE_ROW_OUT),
            _ => {
                let usual =
                    "correct it; `haptical diagnose --list` has the effects with their parameters";
                let (what, next) = text.split_once("; ").unwrap_or((&text, usual));
                Self::in_file("effect", what, device, next)
            }
        }
    }

    /// Refuses a device whose effects have no meaning, at the place of the first such in the text of its file.
    pub(crate) fn refuse_effects(model: &Model, text: &str, path: &Path) -> Result<(), Self> {
        let Err(error) = effects_of(model) else {
            return Ok(());
        };
        let refuses = |count: &usize| {
            let mut first = model.clone();
            first.effects.truncate(*count);
            effects_of(&first).is_err()
        };
        let number = (1..=model.effects.len()).find(refuses);
        let line = number.and_then(|number| line_of(text, model, number));
        let mut refused = Self::effect(&error, path, path);
        refused.place.line = line;
        Err(refused)
    }
}

/// Line of the table of the effect of a number, from 1; joints' compliances, which are no effects of the model, stand
/// between them.
fn line_of(text: &str, model: &Model, number: usize) -> Option<u64> {
    let name = &model.effects.get(number.checked_sub(1)?)?.name;
    let before = model.effects[..number].iter();
    let before = before.filter(|effect| effect.name == *name).count();
    let wanted = format!("\"{name}\"");
    let is_own = |line: &str| line.trim_start().starts_with("name") && line.contains(&wanted);
    let mut lines = text.lines().zip(1..).filter(|(line, _)| is_own(line));
    lines.nth(before.checked_sub(1)?).map(|(_, line)| line)
}
