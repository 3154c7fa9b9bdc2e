//! Sizes of the effects that an earlier model has, in another recording: the columns of their laws belong to a size.

use haptical_calibration::LossChoice;
use haptical_effects::device::{attached_at, effects_of, is_law, settle};
use haptical_effects::{Form, Shape};
use haptical_identification::Interrupt;
use haptical_model::{Device, DeviceEffect, Recording};

use crate::engine::base::Base;
use crate::thresholds::earlier_model::{SIZE_FITS, SIZE_SETTLED};

/// Lets a fit find the sizes of a device's own effects anew, and gives them those that the recording shows, where it shows any:
/// a play that has grown is found with the columns of its new width. `at`: the device whose geometry says where the effects are.
pub(crate) fn own_sizes(
    device: &mut Device,
    at: &Device,
    recording: &Recording,
    (loss, interrupt): (LossChoice, &Interrupt),
) {
    let Ok(own) = effects_of(device) else {
        // the caller attaches them, and says what is wrong
        return;
    };
    for own in &own {
        let spec = own.effect.spec();
        let is_sized = spec.form != Form::Curve
            && is_law(spec).is_ok()
            && spec.shape != Shape::Event
            && !spec.hook.is_on_drives();
        device.effects[own.index].fit |= is_sized;
    }
    for _ in 0..SIZE_FITS {
        let Some(found) = fitted(device, at, recording, (loss, interrupt)) else {
            return;
        };
        let mut pairs = device.effects.iter().zip(&found);
        let is_settled = pairs.all(|(before, now)| !is_resized(before, now));
        for (own, found) in device.effects.iter_mut().zip(found) {
            own.numbers = found.numbers;
        }
        if is_settled {
            return;
        }
    }
}

/// The effects with the sizes that a fit finds beside geometry and drives; none where there is no such fit, or one has no size that
/// nature allows.
fn fitted(
    device: &Device,
    at: &Device,
    recording: &Recording,
    (loss, interrupt): (LossChoice, &Interrupt),
) -> Option<Vec<DeviceEffect>> {
    let mut there = device.clone();
    let with = attached_at(&mut there, at, recording).ok()?;
    if there.effects.iter().all(|own| own.fitted.is_empty()) {
        return None;
    }
    let base = Base::fit(&there, &with, loss, interrupt).ok()?;
    let mut found = base.device;
    if base.unfinished.is_some() {
        return None;
    }
    settle(&mut found, recording, &|_| None).ok()?;
    let mut pairs = device.effects.iter().zip(&found.effects);
    let is_whole = pairs.all(|(own, found)| found.numbers.len() >= own.numbers.len());
    is_whole.then_some(found.effects)
}

/// Whether a number has moved by so much that the columns of the law are other ones.
fn is_resized(before: &DeviceEffect, now: &DeviceEffect) -> bool {
    let mut numbers = now.numbers.iter();
    numbers.any(|(name, now)| {
        let before = before.numbers.get(name).copied().unwrap_or(0.0);
        (now - before).abs() > SIZE_SETTLED * now.abs().max(before.abs())
    })
}
