//! Trust in the calibrated geometry where torques are tested: effects on positions that are
//! not in the model falsify lengths and angles, and these the torques.

use haptical_calibration::Channel;
use haptical_effects::{Context, Stream};

use crate::noise;
use crate::thresholds::torque::POSITION_GAP;

/// Whether the base model leaves more of an external encoder or of the cable than successive rows
/// differ by, and than the sensor's counts hide of it: of a slow motion most rows repeat.
pub(super) fn positions_show_a_gap(context: &Context<'_>) -> bool {
    let recording = context.recording;
    let rest = |stream: &Stream| -> Option<Vec<f64>> {
        let (read, model) = match stream.channel {
            Channel::Output { joint } => (
                recording.output.get(joint)?.as_ref()?,
                context.output.get(joint)?,
            ),
            Channel::Cable { index: 0 } => (
                recording.cable_m.first()?.as_ref()?,
                &context.cable.as_ref()?.length_m,
            ),
            _ => return None,
        };
        Some(read.iter().zip(model).map(|(a, b)| a - b).collect())
    };
    let shows_gap = |stream: &Stream| {
        let rest = rest(stream)?;
        let usable = rest.iter().filter(|value| value.is_finite());
        let count = usable.clone().count().max(1) as f64;
        let rms = (usable.map(|value| value * value).sum::<f64>() / count).sqrt();
        // the standard deviation of rounding to whole counts
        let rounding = noise::rounding::own_count(context, stream) / 12.0_f64.sqrt();
        let sd = noise::difference_sd(&rest, &context.runs)?;
        Some(rms > POSITION_GAP * sd.hypot(rounding))
    };
    let mut streams = context.streams.iter();
    streams.any(|stream| shows_gap(stream) == Some(true))
}
