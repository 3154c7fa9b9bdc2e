//! Lack of fit: channels whose residual is more than noise, or far below the stated noise.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::steps::fitted::parameters_paid_by;
use crate::{ChannelReport, FittedDevice};

/// Residual over noise floor beyond which more than noise is left.
const ABOVE_FLOOR: f64 = 1.5;
/// Chance that noise alone is called more than noise.
const FALSE_ALARM: f64 = 1e-3;
/// Readings per parameter from which on the rows that the fit did not see can be judged by their noise alone: of
/// fewer, the fit's own error is in them, which is the larger the fewer they are.
const READINGS_PER_PARAMETER: f64 = 10.0;

/// Residual over noise floor below which the stated noise is not the reading's. A standard deviation that is stated
/// with care is within a factor of two or three of it: the paper's own cable encoder counts 2.4 times as finely.
const BELOW_FLOOR: f64 = 0.25;
/// Fewest degrees of freedom of which noise does not stay so far below its floor by chance (chi-square: 1e-7).
const ENOUGH: f64 = 30.0;

/// A sentence for every channel whose residual is more than noise.
///
/// The rows of the fit are judged by chi-square with the degrees of freedom that the fit left them, which holds at
/// any number of rows. `judged` are the rows that the fit did not see, or again those that it saw.
pub(crate) fn sentences(
    fitted: &FittedDevice,
    seen: &[ChannelReport],
    judged: &[ChannelReport],
) -> Vec<String> {
    let mut sentences = Vec::new();
    // a pair is a single reading, of which `warnings` has its own sentence
    for report in judged.iter().filter(|report| !report.is_pair()) {
        let own = seen.iter().find(|own| own.channel == report.channel);
        let paid = paid_by(fitted, &report.channel);
        let freedom = own.map_or(0.0, |own| own.readings as f64 - paid);
        let mut left = 0.0;
        if let Some(own) = own.filter(|_| freedom >= 1.0) {
            let rms = own.rms_after_good * (own.readings as f64 / freedom).sqrt();
            if rms > limit(freedom) * own.noise_floor {
                left = rms;
            }
        }
        let has_plenty = own.is_none_or(|own| own.readings as f64 >= READINGS_PER_PARAMETER * paid);
        let is_above = report.rms_after_good > limit(report.readings as f64) * report.noise_floor;
        if has_plenty && is_above {
            left = report.rms_after_good;
        }
        if left > 0.0 {
            sentences.push(format!(
                "{}: the residual left, {left:.3e} {}, is {:.1} times the noise floor: the model lacks an effect, \
                 rows are disturbed, or the stated noise is too small; look at the residual figures for what it \
                 depends on. Beside a missing effect the intervals do not hold: they count noise alone",
                report.channel,
                report.unit,
                left / report.noise_floor
            ));
        }
    }
    sentences
}

/// A sentence for every channel whose residual is far below its noise floor: then the floor is wrong, and what is
/// left may be far above the true one.
pub(crate) fn sentences_of_too_little(
    fitted: &FittedDevice,
    seen: &[ChannelReport],
) -> Vec<String> {
    let is_enough = |report: &&ChannelReport| {
        report.readings as f64 - paid_by(fitted, &report.channel) > ENOUGH
    };
    let is_below =
        |report: &&ChannelReport| report.rms_after_good < BELOW_FLOOR * report.noise_floor;
    let words = |report: &ChannelReport| {
        let ChannelReport {
            channel,
            unit,
            noise_floor,
            rms_after_good: left,
            ..
        } = report;
        if *left < 1e-9 * noise_floor {
            return format!(
                "{channel}: no noise at all is left: the column is computed from others, not measured, and the \
                 intervals that follow from it are too narrow"
            );
        }
        format!(
            "{channel}: the residual left, {left:.3e} {unit}, is far below the noise floor of {noise_floor:.3e} {unit}: \
             the noise or the counts that the device file states (or that stand in their place where it states none) \
             are too coarse, and an effect may hide below that floor; correct sd, counts per revolution or \
             transmission ratio"
        )
    };
    let below = seen.iter().filter(is_enough).filter(is_below);
    below.map(words).collect()
}

/// Residual over noise floor beyond which more than noise is left: of few degrees of freedom, chance alone reaches
/// more (chi-square over its degrees of freedom).
fn limit(freedom: f64) -> f64 {
    let freedom = freedom.max(1.0);
    let largest = ChiSquared::new(freedom).map(|chi| chi.inverse_cdf(1.0 - FALSE_ALARM));
    largest.map_or(ABOVE_FLOOR, |largest| {
        ABOVE_FLOOR.max((largest / freedom).sqrt())
    })
}

/// Parameters that a channel's readings paid for.
fn paid_by(fitted: &FittedDevice, channel: &str) -> f64 {
    let mut channels = fitted.weights.channel_sd.keys();
    let channel = channels.find(|other| other.name() == channel);
    channel.map_or(0.0, |&channel| parameters_paid_by(fitted, channel))
}
