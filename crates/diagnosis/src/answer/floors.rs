//! Noise floors of the channels, checked against everything that is left of them.

use haptical_calibration::Channel;

use crate::answer::{Floor, Unseen};
use crate::engine::Engine;
use crate::noise::{Noise, NoiseSource};
use crate::select::Selection;

/// Every channel's floor. One that is above what the causes leave, on the rows of the fit or on unseen ones, is estimated
/// again from that; where all other sources are gone it stays, contradicted.
pub(crate) fn floors(selection: &Selection<'_>, unseen: &[Unseen]) -> Vec<Floor> {
    let engine = selection.engine();
    let rest = &selection.refit.residual;
    let mut again: Option<Vec<Noise>> = None;
    let mut channels: Vec<Channel> = engine.context.streams.iter().map(|s| s.channel).collect();
    channels.dedup();
    channels
        .into_iter()
        .map(|channel| {
            let floor = floor(engine, channel, &engine.noise);
            let independent = independent(engine, channel);
            let left = channel_rms(engine, channel, rest);
            let own = unseen.iter().filter(|unseen| unseen.channel == channel);
            let unseen: Vec<(f64, f64)> = own.map(Unseen::left).collect();
            let is_above = |floor: &Floor| {
                let mut lefts = unseen.iter().chain([&left]);
                lefts.any(|(rms, count)| *count > 0.0 && floor.is_above(*rms, count * independent))
            };
            if !is_above(&floor) {
                return floor;
            }
            let noise = again.get_or_insert_with(|| engine.noise_of(rest).noise);
            let other = self::floor(engine, channel, noise);
            Floor {
                is_another: true,
                is_contradicted: other.source == NoiseSource::Rest || is_above(&other),
                ..other
            }
        })
        .collect()
}

fn floor(engine: &Engine<'_>, channel: Channel, noise: &[Noise]) -> Floor {
    let by_stream = engine.floors(noise);
    let (mut squares, mut count, mut freedom) = (0.0, 0.0, 0.0);
    let mut shared = f64::INFINITY;
    let mut source = NoiseSource::Repeats;
    for stream in engine.context.streams_of(channel) {
        squares += by_stream[stream].powi(2);
        count += 1.0;
        freedom += noise[stream].freedom;
        shared = noise[stream].freedom.min(shared);
        source = noise[stream].source.max(source);
    }
    // the device file states one number for all axes
    let freedom = match source {
        NoiseSource::Stated => shared,
        _ => freedom,
    };
    let rms = f64::sqrt(squares / f64::max(count, 1.0));
    Floor::new(channel, rms, freedom, source)
}

/// Independent readings in one reading of a channel, its noise's colour allowed for.
fn independent(engine: &Engine<'_>, channel: Channel) -> f64 {
    let streams = engine.context.streams_of(channel);
    streams
        .map(|stream| engine.noise[stream].independent())
        .fold(1.0, f64::min)
}

/// Root mean square of a channel's usable residuals, and their number.
pub(crate) fn channel_rms(
    engine: &Engine<'_>,
    channel: Channel,
    residual: &[Vec<f64>],
) -> (f64, f64) {
    let (mut squares, mut count) = (0.0, 0.0);
    for stream in engine.context.streams_of(channel) {
        let rows = residual[stream].iter().zip(&engine.usable[stream]);
        for (value, _) in rows.filter(|(_, usable)| **usable) {
            squares += value * value;
            count += 1.0;
        }
    }
    (f64::sqrt(squares / f64::max(count, 1.0)), count)
}
