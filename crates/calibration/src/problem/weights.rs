//! Standard deviation of every residual: the channel's own and the motor encoders' quantization.

use std::collections::BTreeMap;

use haptical_model::{Device, Joint, Recording};

use crate::problem::loads::Loads;
use crate::problem::propagated::propagated_variances;
use crate::{CalibrationError, Channel};

/// Stated noise where neither the device file nor the recording gives one: one tenth of a
/// millimetre or milliradian; the residuals' own size then decides the intervals.
const UNSTATED_SD: f64 = 1e-4;

/// Standard deviations of residuals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Weights {
    /// Standard deviation of each channel's own readings, in its unit.
    pub channel_sd: BTreeMap<Channel, f64>,
    /// Factor on each channel's total standard deviation, from the residuals of an earlier fit.
    pub factor: BTreeMap<Channel, f64>,
    /// Weights below 1 of single readings, by line of the log: those that a robust loss distrusts.
    pub distrusted: BTreeMap<Channel, BTreeMap<u64, f64>>,
    /// Local size of a channel's noise over its mean one, by line of the log, where it is uneven.
    pub local_size: BTreeMap<Channel, BTreeMap<u64, f64>>,
}

/// Bits of an estimated size, or weight, that are kept: four digits, of which the data know one or two. The rest depends on how a
/// processor rounds, and would reach every number that is fitted.
const KEPT_BITS: u32 = 13;

/// An estimated size or weight with the digits that it has.
pub(crate) fn to_its_digits(size: f64) -> f64 {
    let dropped = 1_u64 << (f64::MANTISSA_DIGITS - 1 - KEPT_BITS);
    // above all finite numbers a carry would make infinity
    let rounded = f64::from_bits((size.to_bits() + dropped / 2) & !(dropped - 1));
    if rounded.is_finite() { rounded } else { size }
}

/// Least weight of a reading: none would leave its standard deviation without a number.
const LEAST_WEIGHT: f64 = 1e-12;

impl Weights {
    /// The device file's figures.
    pub fn stated(device: &Device, channels: &[Channel]) -> Self {
        let channel_sd = channels
            .iter()
            .map(|&channel| {
                let sd = channel.stated_sd(device);
                (channel, sd.unwrap_or(UNSTATED_SD))
            })
            .collect();
        Self {
            channel_sd,
            ..Self::default()
        }
    }

    /// Weight of one reading, 0 to 1.
    pub fn trust(&self, channel: Channel, line: u64) -> f64 {
        let lines = self.distrusted.get(&channel);
        lines
            .and_then(|lines| lines.get(&line))
            .map_or(1.0, |weight| weight.clamp(0.0, 1.0))
    }

    /// The same without the look at single readings: what the noise is, not what each reading counts.
    #[must_use]
    pub fn trusting(&self) -> Self {
        Self {
            distrusted: BTreeMap::new(),
            local_size: BTreeMap::new(),
            ..self.clone()
        }
    }

    /// Largest change of a weight's root, and of the logarithm of a channel's factor, to other weights.
    pub(crate) fn change_to(&self, after: &Self) -> f64 {
        let mut largest: f64 = 0.0;
        for (a, b) in [(self, after), (after, self)] {
            for (&channel, lines) in &a.distrusted {
                for (&line, weight) in lines {
                    let moved = weight.sqrt() - b.trust(channel, line).sqrt();
                    largest = largest.max(moved.abs());
                }
            }
        }
        for (channel, factor) in &after.factor {
            let old = self.factor.get(channel).copied().unwrap_or(1.0);
            largest = largest.max((factor / old).ln().abs());
        }
        largest
    }

    /// The standard deviation that all residuals of a channel share; none where the step of a reading adds
    /// to it, which differs from row to row.
    pub(crate) fn common_sd(&self, device: &Device, channel: Channel) -> Option<f64> {
        let has_steps = |joint: &Joint| joint.reading_quantum_rad().is_some_and(|step| step != 0.0);
        let is_stepped = match channel {
            Channel::Output { joint } => has_steps(device.joints.get(joint)?),
            _ => device.joints.iter().any(has_steps),
        };
        let (own, factor) = self.own_sd(channel);
        let is_even = [&self.distrusted, &self.local_size]
            .iter()
            .all(|lines| !lines.contains_key(&channel));
        let is_common = !is_stepped && is_even;
        is_common.then(|| factor * (own * own).sqrt())
    }

    /// A channel's own standard deviation, and the factor on the whole.
    fn own_sd(&self, channel: Channel) -> (f64, f64) {
        let own = self.channel_sd.get(&channel).copied();
        let factor = self.factor.get(&channel).copied();
        (own.unwrap_or(UNSTATED_SD), factor.unwrap_or(1.0))
    }

    /// Standard deviation of a channel's residual at each row of the recording (rows without a
    /// reading included): var = factor^2 (sd^2 + sum_i (d residual / d reading_i)^2 q_i^2 / 12)
    /// over the row's trust, times the square of its local size, q_i the step of joint i's reading (docs/equations.md, "Propagated quantization"). For
    /// positions and orientations the mean over the three axes.
    ///
    /// # Errors
    /// [`CalibrationError::Row`] where the device has no value.
    pub fn residual_sd(
        &self,
        device: &Device,
        recording: &Recording,
        channel: Channel,
    ) -> Result<Vec<f64>, CalibrationError> {
        let loads = Loads::new(device, recording)?;
        let variances = propagated_variances(device, recording, channel, loads.as_ref())?;
        Ok(self.with_variances(recording, channel, variances))
    }

    /// The same with the variances that the rounding of the readings adds ([`propagated_variances`]).
    pub(crate) fn with_variances(
        &self,
        recording: &Recording,
        channel: Channel,
        mut deviations: Vec<f64>,
    ) -> Vec<f64> {
        let (own, factor) = self.own_sd(channel);
        let sizes = self.local_size.get(&channel);
        for (row, value) in deviations.iter_mut().enumerate() {
            let line = recording.line.get(row).copied().unwrap_or(0);
            let trust = self.trust(channel, line).max(LEAST_WEIGHT);
            let size = sizes.and_then(|sizes| sizes.get(&line)).copied();
            *value = factor * (own * own + *value).sqrt() / trust.sqrt() * size.unwrap_or(1.0);
        }
        deviations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_keep_four_digits() {
        for size in [1.234_567_8, 0.999_999_9, 3.3e-7, 8.1e300, f64::MIN_POSITIVE] {
            let kept = to_its_digits(size);
            assert!((kept / size - 1.0).abs() <= 1e-4, "{size} {kept}");
            // as another processor may have it
            let near = to_its_digits(size * (1.0 + 1e-15));
            assert_eq!(kept, near);
        }
        assert_eq!(to_its_digits(0.0), 0.0);
        assert_eq!(to_its_digits(1.0), 1.0);
        assert_eq!(to_its_digits(f64::MAX), f64::MAX);
        assert!(to_its_digits(f64::NAN).is_nan());
        assert!(to_its_digits(f64::INFINITY).is_infinite());
    }
}
