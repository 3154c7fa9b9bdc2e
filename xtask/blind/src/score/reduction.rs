//! The share of the gap that an answer really closes, against channels without noise.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::laws::rms;
use crate::rig::scene::CleanChannels;

/// What a model predicts for one reading, without and with the named causes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Row of the recording, from 0.
    pub row: usize,
    /// Without the causes.
    pub before: f64,
    /// With them.
    pub after: f64,
}

/// The true gap of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrueReduction {
    /// Root mean square of prediction less truth, without the causes, in the channel's unit.
    pub rms_before: f64,
    /// With them.
    pub rms_after: f64,
    /// Root mean square of what the rounding of the motor-side readings puts on any prediction, in the
    /// channel's unit.
    pub rounding: f64,
    /// `100 (1 - sqrt(max(0, after^2 - rounding^2) / (before^2 - rounding^2)))` \[%\]; absent where there was
    /// no gap.
    pub percent: Option<f64>,
}

/// True reductions of all channels in `predictions` (`out2`, `cable`, `cable2`, ...) that `clean` has.
/// Rows that the recording does not have are left out.
pub fn true_reductions(
    predictions: &BTreeMap<String, Vec<Prediction>>,
    clean: &CleanChannels,
) -> BTreeMap<String, TrueReduction> {
    predictions
        .iter()
        .filter_map(|(channel, of_channel)| {
            let truth = clean.channel(channel)?;
            let gap = |pick: fn(&Prediction) -> f64| {
                let differences: Vec<f64> = of_channel
                    .iter()
                    .filter_map(|one| Some(pick(one) - truth.get(one.row)?))
                    .filter(|difference| difference.is_finite())
                    .collect();
                rms(&differences)
            };
            let (rms_before, rms_after) = (gap(|one| one.before), gap(|one| one.after));
            let name = channel.split('_').next().unwrap_or(channel);
            let rounding = clean.rounding.get(name).copied().unwrap_or(0.0);
            let beyond = |rms: f64| rms * rms - rounding * rounding;
            let percent = (beyond(rms_before) > 0.0).then(|| {
                let left = beyond(rms_after).max(0.0) / beyond(rms_before);
                100.0 * (1.0 - libm::sqrt(left))
            });
            let reduction = TrueReduction {
                rms_before,
                rms_after,
                rounding,
                percent,
            };
            Some((channel.clone(), reduction))
        })
        .collect()
}

/// The share of the gap of all channels together that is closed \[%\], each channel in the standard deviation of its noise:
/// `100 (1 - sqrt(sum(max(0, after^2 - rounding^2) / sd^2) / sum(max(0, before^2 - rounding^2) / sd^2)))`; below 0 where the
/// gap grew. None where there was no gap. Channels without a noise are left out.
///
/// ```
/// use std::collections::BTreeMap;
/// use xtask_blind::{TrueReduction, closed_percent};
/// let of = |rms_before, rms_after| TrueReduction { rms_before, rms_after, rounding: 0.0, percent: None };
/// let channels = BTreeMap::from([("out1".to_owned(), of(3e-3, 0.0)), ("cable".to_owned(), of(4e-6, 5e-7))]);
/// let noise = BTreeMap::from([("out1".to_owned(), 1e-3), ("cable".to_owned(), 1e-6)]);
/// assert_eq!(closed_percent(&channels, &noise).map(f64::round), Some(90.0));
/// ```
pub fn closed_percent(
    reductions: &BTreeMap<String, TrueReduction>,
    noise_sd: &BTreeMap<String, f64>,
) -> Option<f64> {
    let (mut before, mut after) = (0.0, 0.0);
    for (channel, own) in reductions {
        let Some(sd) = noise_sd.get(channel).filter(|sd| **sd > 0.0) else {
            continue;
        };
        let beyond = |rms: f64| (rms * rms - own.rounding * own.rounding).max(0.0) / (sd * sd);
        before += beyond(own.rms_before);
        after += beyond(own.rms_after);
    }
    (before > 0.0).then(|| 100.0 * (1.0 - libm::sqrt(after / before)))
}

impl CleanChannels {
    /// The channel of that name: `out1`, `out2`, ..., `cable`, `cable2`, ... (a unit suffix may follow).
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        channel_of(name, &self.output_rad, &self.cable_m)?.as_deref()
    }
}

/// What belongs to a channel, of what there is for external encoders and for cables.
pub fn channel_of<'c, T>(name: &str, outputs: &'c [T], cables: &'c [T]) -> Option<&'c T> {
    let name = name.split('_').next().unwrap_or(name);
    let place = |number: &str| number.parse::<usize>().ok()?.checked_sub(1);
    if let Some(number) = name.strip_prefix("out") {
        return outputs.get(place(number)?);
    }
    match name.strip_prefix("cable")? {
        "" => cables.first(),
        number => cables.get(place(number)?),
    }
}
