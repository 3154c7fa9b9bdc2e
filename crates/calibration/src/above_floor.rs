//! Whether more than noise is left of a channel's residuals.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::joint_fit::parameters_paid_by;
use crate::{ChannelReport, FittedDevice};

/// Residual over noise floor beyond which more than noise is left.
const ABOVE_FLOOR: f64 = 1.5;
/// Chance that noise alone is called more than noise.
const FALSE_ALARM: f64 = 1e-3;
/// Readings per parameter from which on the rows that the fit did not see can be judged by their noise alone: of
/// fewer, the fit's own error is in them, which is the larger the fewer they are.
const READINGS_PER_PARAMETER: f64 = 10.0;

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
    for report in judged {
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
                 depends on",
                report.channel,
                report.unit,
                left / report.noise_floor
            ));
        }
    }
    sentences
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
