//! Trust in the calibrated geometry where torques are tested: effects on positions that are
//! not in the model falsify lengths and angles, and these the torques.

use haptical_calibration::Channel;
use haptical_effects::Context;

use super::base::Base;
use crate::noise;
use crate::thresholds::torque::{POSITION_GAP, STRAIN, WEIGHT_STRAIN};

/// Squares of what the torques pull each row parameter by, over its tolerance, per parameter.
fn strain(base: &Base) -> f64 {
    let count = base.geometry.len().max(1) as f64;
    base.strain(base.geometry.clone()) / count
}

/// Whether the structure of the torques may come from a falsified geometry: they pull at it, and
/// the positions show a gap.
pub(super) fn is_falsified(context: &Context<'_>, base: &Base) -> bool {
    strain(base) > STRAIN && positions_show_a_gap(context)
}

/// Whether the geometry stays within its tolerance.
pub(super) fn is_within_tolerance(base: &Base) -> bool {
    strain(base) <= 1.0
}

/// Whether weights can be judged.
pub(super) fn weighs(base: &Base) -> bool {
    strain(base) <= WEIGHT_STRAIN
}

/// Whether the base model leaves more of an external encoder or of the cable than successive rows
/// differ by, and than the sensor's counts hide of it: of a slow motion most rows repeat.
pub(super) fn positions_show_a_gap(context: &Context<'_>) -> bool {
    let recording = context.recording;
    context.streams.iter().any(|stream| {
        let (read, model) = match stream.channel {
            Channel::Output { joint } => (
                recording.output.get(joint).and_then(Option::as_ref),
                context.output.get(joint),
            ),
            Channel::Cable { index: 0 } => (
                recording.cable_m.first().and_then(Option::as_ref),
                context.cable.as_ref().map(|cable| &cable.length_m),
            ),
            _ => (None, None),
        };
        let (Some(read), Some(model)) = (read, model) else {
            return false;
        };
        let rest: Vec<f64> = read.iter().zip(model).map(|(a, b)| a - b).collect();
        let usable = rest.iter().filter(|value| value.is_finite());
        let count = usable.clone().count().max(1) as f64;
        let rms = (usable.map(|value| value * value).sum::<f64>() / count).sqrt();
        // the standard deviation of rounding to whole counts
        let rounding = noise::rounding::own_count(context, stream) / 12.0_f64.sqrt();
        noise::difference_sd(&rest, &context.runs)
            .is_some_and(|sd| rms > POSITION_GAP * sd.hypot(rounding))
    })
}
