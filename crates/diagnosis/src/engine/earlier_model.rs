//! A model identified earlier, put where a recording was made, with the sizes that its effects have there.

use haptical_calibration::{
    Channel, FitRequest, LossChoice, Options, Weights, fit_parameters, prepare_device,
    with_unseen_places,
};
use haptical_effects::device::{attached_at, effects_of, is_law, settle};
use haptical_effects::{Form, Shape};
use haptical_identification::Interrupt;
use haptical_model::{Device, DeviceEffect, ParameterId, Recording, SurroundingParameter};

use crate::Result;
use crate::engine::Base;
use crate::thresholds::earlier_model::{SIZE_FITS, SIZE_SETTLED};

/// The earlier model placed in the recording: the device is the model's, and what was touched is the
/// recording's, placed as the model has it best. Nobody puts a socket back to a tenth of a millimetre, and the
/// same name may be another place.
pub(crate) fn placed(
    model: &Device,
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Result<Base> {
    let mut there = match model.mounts(recording) {
        Ok(_) => model.clone(),
        // a run or a tool of which the model has no place
        Err(_) => with_unseen_places(model, recording)?,
    };
    if channels.iter().any(|channel| is_touched(*channel)) {
        let (own, rig) = (&mut there.surroundings, &device.surroundings);
        own.contacts.clone_from(&rig.contacts);
        own.planes.clone_from(&rig.planes);
        own.plane_pairs.clone_from(&rig.plane_pairs);
        own.contact_sd_m = rig.contact_sd_m;
        own.plane_sd_m = rig.plane_sd_m;
        there.contact_pairs.clone_from(&device.contact_pairs);
        there = prepare_device(&there, recording)?;
        let places = places(&there);
        let weights = Weights::stated(&there, channels);
        let options = Options {
            starts: 0,
            unfinished: true,
            ..Options::default()
        };
        let what = "places of what was touched";
        let fit = fit_parameters(&FitRequest {
            what,
            device: &there,
            recording,
            channels,
            parameters: &places,
            unsupported: &[],
            weights: &weights,
            options: &options,
            start: None,
            yielded: None,
        })?;
        there = fit.device;
    }
    Ok(Base::held(there, channels.to_vec()))
}

/// Numbers of touched points and planes.
pub(crate) fn places(device: &Device) -> Vec<ParameterId> {
    let all = device.surrounding_parameters().into_iter();
    let touched = all.filter(|parameter| {
        use SurroundingParameter::{Contact, Plane};
        matches!(parameter, Contact { .. } | Plane { .. })
    });
    touched.map(ParameterId::Surrounding).collect()
}

/// Whether a channel is about places that are touched.
fn is_touched(channel: Channel) -> bool {
    match channel {
        Channel::Contact
        | Channel::ContactPair { .. }
        | Channel::Plane
        | Channel::PlanePair { .. } => true,
        Channel::Output { .. }
        | Channel::Cable { .. }
        | Channel::Position
        | Channel::Orientation
        | Channel::Fixture { .. } => false,
    }
}

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
