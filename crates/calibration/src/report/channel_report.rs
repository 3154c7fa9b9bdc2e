//! One channel before and after a calibration.

use haptical_metrics::gap_reduction_percent;
use haptical_model::{Device, Recording};
use serde::Serialize;

use crate::{Channel, ChannelResiduals};

/// What one hand of a device shows of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandReport {
    /// Name of the hand.
    pub hand: String,
    /// Readings.
    pub readings: usize,
    /// Root mean square of the nominal device's residuals.
    pub rms_before: f64,
    /// Root mean square of the calibrated device's residuals.
    pub rms_after: f64,
}

/// One channel before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelReport {
    /// Channel name: `out2`, `cable`.
    pub channel: String,
    /// Joint (from 1) of an external encoder.
    pub joint: Option<usize>,
    /// Unit.
    pub unit: String,
    /// Readings.
    pub readings: usize,
    /// Readings left out, because a polynomial was outside its range there.
    pub outside_range: usize,
    /// Root mean square of the nominal device's residuals.
    pub rms_before: f64,
    /// Standard deviation of the nominal device's residuals (their mean taken off).
    pub sd_before: f64,
    /// Root mean square of the calibrated device's residuals.
    pub rms_after: f64,
    /// The same on all rows of the log, those of the fit and those that it did not see: the identified device, replayed on that log,
    /// leaves as much.
    pub rms_fit: Option<f64>,
    /// Standard deviation of the calibrated device's residuals.
    pub sd_after: f64,
    /// Root mean square of the nominal device's residuals, outliers left out.
    pub rms_before_good: f64,
    /// Root mean square of the calibrated device's residuals, outliers left out.
    pub rms_after_good: f64,
    /// Readings that noise does not explain, where a robust loss looked for them.
    pub outliers: usize,
    /// Root mean square of the stated noise, quantization included.
    pub noise_floor: f64,
    /// Share of the gap that was closed, noise taken out; none where there was no gap.
    pub reduction_percent: Option<f64>,
    /// The same, outliers left out.
    pub reduction_percent_good: Option<f64>,
    /// Hand by hand, outliers left out; empty where the device has but one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hands: Vec<HandReport>,
    /// Residuals before, in the order of the rows.
    #[serde(skip)]
    pub before: Vec<f64>,
    /// Residuals after.
    #[serde(skip)]
    pub after: Vec<f64>,
    /// Rows of the recording.
    #[serde(skip)]
    pub rows: Vec<usize>,
}

impl ChannelReport {
    /// The figures without the residuals of the rows, which of a long log are most of the report.
    #[must_use]
    pub fn figures(&self) -> Self {
        Self {
            channel: self.channel.clone(),
            unit: self.unit.clone(),
            hands: self.hands.clone(),
            before: Vec::new(),
            after: Vec::new(),
            rows: Vec::new(),
            ..*self
        }
    }

    /// A channel's residuals before and after the calibration.
    pub(crate) fn new(device: &Device, before: ChannelResiduals, after: ChannelResiduals) -> Self {
        let channel = before.channel;
        let (rms_before, rms_after) = (before.rms().unwrap_or(0.0), after.rms().unwrap_or(0.0));
        let spread = |residuals: &[f64], rms: f64| {
            let mean = residuals.iter().sum::<f64>() / residuals.len() as f64;
            (rms * rms - mean * mean).max(0.0).sqrt()
        };
        let reduction_percent = gap_reduction_percent(rms_before, rms_after, after.noise_floor);
        Self {
            channel: channel.name(),
            joint: match channel {
                Channel::Output { joint } => Some(joint + 1),
                _ => None,
            },
            unit: channel.unit(device).to_owned(),
            readings: before.residuals.len(),
            outside_range: before.outside_range,
            rms_before,
            sd_before: spread(&before.residuals, rms_before),
            rms_after,
            rms_fit: None,
            sd_after: spread(&after.residuals, rms_after),
            rms_before_good: rms_before,
            rms_after_good: rms_after,
            outliers: 0,
            noise_floor: after.noise_floor,
            reduction_percent,
            reduction_percent_good: reduction_percent,
            hands: Vec::new(),
            before: before.residuals,
            after: after.residuals,
            rows: before.rows,
        }
    }

    /// Says what each hand of a device shows of the channel; the lines `outliers` are left out.
    pub(crate) fn tell_hands(&mut self, device: &Device, recording: &Recording, outliers: &[u64]) {
        let Some(named) = &recording.hand else {
            return;
        };
        let width = self.before.len() / self.rows.len().max(1);
        for hand in &device.hands {
            let is_own =
                |row: usize| named[row] == hand.name && !outliers.contains(&recording.line[row]);
            let own: Vec<usize> = (0..self.before.len())
                .filter(|place| is_own(self.rows[place / width]))
                .collect();
            let rms = |residuals: &[f64]| {
                let square: f64 = own.iter().map(|place| residuals[*place].powi(2)).sum();
                (square / own.len() as f64).sqrt()
            };
            if !own.is_empty() {
                self.hands.push(HandReport {
                    hand: hand.name.clone(),
                    readings: own.len(),
                    rms_before: rms(&self.before),
                    rms_after: rms(&self.after),
                });
            }
        }
    }

    /// Whether the channel is one reading of the whole recording, about two things that were touched.
    pub(crate) fn is_pair(&self) -> bool {
        ["contact-pair", "plane-pair"]
            .iter()
            .any(|name| self.channel.starts_with(name))
    }
}
