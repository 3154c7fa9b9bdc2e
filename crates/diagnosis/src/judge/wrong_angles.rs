//! Torques caused by a gap of positions: effects on torques that are no larger are not reported.

use haptical_calibration::Channel;
use haptical_effects::{Context, Hook};
use nalgebra::Vector3;

use crate::engine::{Cause, Engine};
use crate::select::Selection;

/// What the holding torques are wrong by where the model's angles are \[Nm\]: about the torque times the angle, the largest
/// that a gap or a cause shows, or by which an effect of the device itself moves what is seen: the chain of the torques is
/// that of the joints without it.
pub(crate) fn torque_nm(selection: &Selection<'_>) -> f64 {
    let context = &selection.engine().context;
    let torques = context.torque_nm.iter().flatten();
    let torque_nm = torques.map(|torque| rms(torque)).fold(0.0, f64::max);
    let gaps = (0..context.streams.len()).map(|stream| gap_rad(selection.engine(), stream));
    let causes = selection.causes().iter();
    let causes = causes.map(|cause| cause_rad(selection, cause));
    let own = context.recording.added.iter();
    // what an effect adds to torques moves no angle
    let own = own.filter(|added| !added.channel.starts_with("torque"));
    let own = own.map(|added| rms(&added.readings) / arm_m(context, &added.channel));
    torque_nm * gaps.chain(causes).chain(own).fold(0.0, f64::max)
}

/// What a channel shows of an angle of 1 rad, about: the length of a cable or the handle's distance from frame (-1) \[m\].
fn arm_m(context: &Context<'_>, channel: &str) -> f64 {
    let arm_m = match (channel, &context.cable) {
        ("position", _) => {
            let squares = context.position.iter().map(Vector3::norm_squared);
            (squares.sum::<f64>() / context.rows().max(1) as f64).sqrt()
        }
        (name, Some(cable)) if name.starts_with("cable") => rms(&cable.length_m),
        _ => 1.0,
    };
    arm_m.max(1e-3)
}

/// The base model's gap in a stream, a cable's over its length.
fn gap_rad(engine: &Engine<'_>, stream: usize) -> f64 {
    let context = &engine.context;
    let gap = rms(&engine.start.residual[stream]).powi(2) - engine.floor[stream].powi(2);
    let arm_m = match context.streams[stream].channel {
        channel @ Channel::Cable { .. } => arm_m(context, &channel.name()),
        _ => 1.0,
    };
    gap.max(0.0).sqrt() / arm_m
}

/// The angle by which a cause moves its joint, from what the chain sees of it.
fn cause_rad(selection: &Selection<'_>, cause: &Cause) -> f64 {
    let context = &selection.engine().context;
    let effect = selection.effect(cause);
    let Some(joint) = effect.joint() else {
        return 0.0;
    };
    if !matches!(effect.spec().hook, Hook::Transmission | Hook::Joint) {
        return 0.0;
    }
    let signal = cause.contribution(selection.selector.effects, context);
    let seen = signal.parts.iter().filter_map(|(stream, values)| {
        let lever: Vec<f64> = (0..context.rows())
            .map(|row| context.sensitivity(*stream, joint, row))
            .collect();
        let lever = rms(&lever);
        (lever > 0.0).then(|| rms(values) / lever)
    });
    seen.fold(0.0, f64::max)
}

/// Root mean square of the finite values; 0 of none.
fn rms(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    haptical_metrics::rms(&finite).unwrap_or(0.0)
}
