//! What the effects of a device add to the readings of a recording.

use std::borrow::Cow;

use haptical_calibration::channels;
use haptical_model::{AddedBy, AddedReadings, Device, JOINT_FRICTION, Recording};

use crate::device::bare::bare;
use crate::device::error::DeviceEffectError;
use crate::device::fit::fit_numbers;
use crate::device::resolve::{OwnEffect, effects_of};
use crate::{Context, Follows, Signal, Stream, streams};

/// A recording with what the effects of a device add to its readings ([`Recording::added`]), torques among them; `device` gets the
/// numbers with which each effect that is to be fitted is fitted, none for those on torques, which no calibration fits. The recording itself for a device without effects.
///
/// An effect that the recording cannot show, for want of the channel that shows it, adds nothing; one on drives adds nothing to
/// postures without times. One whose covariate is missing is refused.
///
/// # Errors
/// [`DeviceEffectError`].
pub fn attached<'r>(
    device: &mut Device,
    recording: &'r Recording,
) -> Result<Cow<'r, Recording>, DeviceEffectError> {
    let at = device.clone();
    attached_at(device, &at, recording)
}

/// The same with postures and loads by the geometry of another device, `at`: the nominal lengths of a device that yields by
/// centimetres are no good to say how far its handle moves.
///
/// # Errors
/// [`DeviceEffectError`].
pub fn attached_at<'r>(
    device: &mut Device,
    at: &Device,
    recording: &'r Recording,
) -> Result<Cow<'r, Recording>, DeviceEffectError> {
    let own = effects_of(device)?;
    if own.is_empty() {
        return Ok(Cow::Borrowed(recording));
    }
    let base = bare(at);
    let channels = channels(&base, recording).unwrap_or_default();
    let streams = streams(&base, &channels);
    // friction follows speeds and recorded torques
    let is_friction = |own: &OwnEffect| own.effect.spec().name == JOINT_FRICTION;
    let mut context = match streams.is_empty() && own.iter().all(is_friction) {
        true => Context::of_drives(&base, recording)?,
        false => Context::new(&base, recording, &streams)?,
    };
    let mut with = recording.clone();
    with.added.clear();
    let mean_degc = context.reference_degc;
    for effect in &own {
        if let Some(why) = effect.effect.untestable(&context)
            && effect.effect.lacks_covariate(&context)
        {
            let label = device.effects[effect.index].label();
            return Err(DeviceEffectError::Untestable { label, why });
        }
        context.set_reference_degc(effect.reference_degc().unwrap_or(mean_degc));
        // a calibration has no channel that torques are
        let fit = device.effects[effect.index].fit && !effect.effect.spec().hook.is_on_drives();
        let numbers = fit.then(|| fit_numbers(effect, &context));
        with.added
            .extend(added_by(effect, &context, &streams, numbers.is_some()));
        device.effects[effect.index].fitted = numbers.unwrap_or_default();
    }
    Ok(Cow::Owned(with))
}

/// What one effect adds, stream by stream.
fn added_by(
    own: &OwnEffect,
    context: &Context<'_>,
    streams: &[Stream],
    is_fitted: bool,
) -> Vec<AddedReadings> {
    let (amplitudes, shape) = own.amplitudes(context);
    let signal = own.effect.exact_signal(context, &amplitudes, shape);
    let slopes = match is_fitted {
        true => slopes(own, context, &amplitudes, shape),
        false => Vec::new(),
    };
    let mut at = Vec::new();
    if is_fitted {
        at.clone_from(&amplitudes);
        at.resize(slopes.len(), 0.0);
    }
    let spec = own.effect.spec();
    let by = match spec.hook.is_on_drives() {
        true if spec.name == JOINT_FRICTION => AddedBy::Friction,
        true if spec.follows == Follows::Torque => AddedBy::Reading,
        _ => AddedBy::Motion,
    };
    let rows = context.rows();
    let on = |signal: &Signal, stream: usize| {
        let values = signal.on(stream).map(<[f64]>::to_vec);
        values.unwrap_or_else(|| vec![0.0; rows])
    };
    let is_on = |stream: &usize| {
        let mut signals = slopes.iter().chain([&signal]);
        signals.any(|signal| signal.on(*stream).is_some())
    };
    let joints = context.device.joints.iter().enumerate();
    let torques = joints.filter_map(|(joint, own)| {
        let stream = context.torque_stream(joint)?;
        Some((stream, own.torque_column(joint + 1), 0))
    });
    let of_stream = |(index, own): (usize, &Stream)| (index, own.channel.name(), own.axis);
    let all = streams.iter().enumerate().map(of_stream).chain(torques);
    let shown = all.filter(|(stream, ..)| is_on(stream));
    let added = shown.map(|(stream, channel, axis)| AddedReadings {
        effect: own.index,
        channel,
        axis,
        by,
        readings: on(&signal, stream),
        at: at.clone(),
        slopes: slopes.iter().map(|slope| on(slope, stream)).collect(),
    });
    added.collect()
}

/// Derivatives by each amplitude and, last, by the logarithm of a continuous shape.
fn slopes(own: &OwnEffect, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal> {
    let effect = own.effect.as_ref();
    let mut slopes = effect.derivative(context, amplitudes, shape);
    if effect.spec().shape.is_continuous() {
        let step = effect.shape_step(context, shape);
        let at = |shape: f64| effect.signal(context, amplitudes, shape);
        let mut slope = Signal::default();
        slope.add(&at(shape * (1.0 + step)), 0.5 / step);
        slope.add(&at(shape * (1.0 - step)), -0.5 / step);
        slopes.push(slope);
    }
    slopes
}
